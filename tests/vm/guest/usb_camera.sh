# The kernel's uvcvideo on a USB camera made of software: YUYV, MJPEG, broken frames, unplug and replug.
. "$VM/guest/common.sh"
usb=$BUILT/usb_camera

modprobe vhci-hcd || echo "FAIL vhci-hcd"
modprobe uvcvideo nodrop=1 || echo "FAIL uvcvideo"
jpegs=$(ls $MADE/jpeg/*.jpg)

plug() {
  "$usb" --jpeg $jpegs "$@" 2>/tmp/usb.log &
  camera=$!
  for _ in $(seq 100); do [ -e /dev/video0 ] && return 0; sleep 0.1; done
  echo "FAIL no camera appears: $(cat /tmp/usb.log)"
}
unplug() {
  kill $camera 2>/dev/null
  wait $camera 2>/dev/null
  for _ in $(seq 100); do [ -e /dev/video0 ] || return 0; sleep 0.1; done
  echo "FAIL the camera stays"
}

# with NAME FORMAT FAULT FRAME SECONDS EVENT...: records while the camera fails by itself
with() {
  local name=$1 format=$2 fault=$3 at=$4 seconds=$5 out=usb_$3_$2
  shift 5
  plug --fault $fault $at
  timeout --kill-after=60 60 "$HEARTSERVO" capture /dev/video0,format=$format,give-up-s=20 --grey --seconds $seconds --quiet --out $out >/tmp/out 2>/tmp/err
  local code=$?
  [ $code -eq 0 ] || echo "FAIL $name: ended with $code: $(cat /tmp/err)"
  says "$name" $out/summary.json "$@"
  unplug
}

plug
check "list" 20 "$HEARTSERVO" capture --list
says "shows it" /tmp/out "uvcvideo" "YUYV" "MJPG" "640x480 at 12.5 Hz"
check "YUYV" 60 "$HEARTSERVO" capture /dev/video0,format=YUYV --frames 15 --quiet --out yuyv
says "time stamps of the exposure's start" yuyv/summary.json '"time_stamps": "monotonic clock, start of exposure"' '"frames": 15'
check "MJPG" 60 "$HEARTSERVO" capture /dev/video0,format=MJPG --frames 15 --quiet --out mjpg
says "its format" mjpg/summary.json '"format": "MJPG 640x480 at 12.5' '"frames": 15'
check "tracked" 100 "$HEARTSERVO" track v4l2:/dev/video0,format=MJPG --roi "$(cat $MADE/roi)" --frames 30 --quiet --out usb_track
unplug

with "a failing transfer" YUYV error 20 4 '"event_counts"'
with "half a frame" YUYV short 20 4 '"(bad_picture|sequence_gap|bad_buffer)": '
with "garbage in a JPEG" MJPG garbage 20 4 '"bad_picture": '
with "freeze" YUYV freeze 20 5 '"starved": ' '"restarted": '

plug --fault unplug 30
timeout 60 "$HEARTSERVO" capture /dev/video0,format=YUYV,give-up-s=20 --grey --seconds 8 --quiet --out replug >/tmp/out 2>/tmp/err &
job=$!
wait $camera
sleep 1.5
plug
wait $job || echo "FAIL unplug and replug: $(cat /tmp/err)"
says "unplug and replug, recording" replug/summary.json '"unplugged": 1' '"reopened": 1' '"recovered": 1'
rows=$(($(wc -l <replug/frames.csv) - 1))
says "no recorded frame lost" replug/summary.json "\"frames\": $rows,"
unplug

plug --fault unplug 30
timeout 60 "$HEARTSERVO" servo v4l2:/dev/video0,format=MJPG --roi "$(cat $MADE/roi)" --settle-s 0 --frames 80 --quiet --out servo_replug >/tmp/out 2>/tmp/err &
job=$!
wait $camera
sleep 1.5
plug
wait $job
code=$?
[ $code -eq 0 ] || [ $code -eq 5 ] || echo "FAIL replug while servoing: $code $(cat /tmp/err)"
says "unplug and replug, servoing" servo_replug/summary.json '"unplugged": 1' '"recovered": 1'
unplug

plug --fault unplug 30
timeout 60 "$HEARTSERVO" capture /dev/video0,format=YUYV,give-up-s=2 --grey --seconds 20 --quiet --out lost >/tmp/out 2>/tmp/err
code=$?
[ $code -eq 4 ] && [ "$(wc -l </tmp/err)" -eq 1 ] && grep -q "did not come back within 2 s" /tmp/err &&
  echo "PASS a camera that does not come back: $(cat /tmp/err)" || echo "FAIL a camera that does not come back: $code $(cat /tmp/err)"
says "its frames are kept" lost/summary.json '"gave_up": 1'
