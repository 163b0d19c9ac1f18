# By hand, for docs/capture.md: what vpV4l2Grabber and cv::VideoCapture see on vivid's faults.
#   (libvisp-sensor-dev installed)
#   cmake --build --preset release --target peer_capture
#   tests/vm/boot.sh tests/vm/guest/peers.sh build/release/heartservo 1800 vivid
. "$VM/guest/common.sh"
peer=$BUILT/peer_capture

webcam() { vivid node_types=0x1 num_inputs=1 input_types=0x0; timeout 10 v4l2-ctl -d /dev/video0 -v width=320,height=180 >/dev/null; }
hdmi() { vivid node_types=0x1 num_inputs=1 input_types=0x3; timeout 10 v4l2-ctl -d /dev/video0 --set-dv-bt-timings index=0 >/dev/null; }
seen() {  # WHO NAME SETUP COMMAND...
  local who=$1 name=$2 setup=$3
  shift 3
  $setup
  timeout --kill-after=3 60 "$peer" $who /dev/video0 6 >/tmp/seen 2>&1 &
  local job=$!
  for _ in $(seq 200); do grep -q "first frame" /tmp/seen && break; sleep 0.1; done
  sleep 1
  "$@"
  wait $job
  echo "$who, $name: ended with $?"
  cut -c1-200 /tmp/seen | head -12
}
nothing() { :; }
bad() { control inject_v4l2_buf_flag_error=1; }
dropped() { control percentage_of_dropped_buffers=60; sleep 1; control percentage_of_dropped_buffers=0; }
fatal() { control inject_fatal_streaming_error=1; }
gone() { control disconnect=1; }
no_signal() { control dv_timings_signal_mode=1; }
for who in opencv visp; do
  seen $who "no fault" webcam nothing
  seen $who "bad buffer" webcam bad
  seen $who "dropped buffers" webcam dropped
  seen $who "fatal error" webcam fatal
  seen $who "disconnected" webcam gone
  seen $who "no signal" hdmi no_signal
done
echo "PASS peers"
