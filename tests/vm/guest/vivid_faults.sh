# Every fault that vivid can inject, while recording and while servoing: named, recovered from, no recorded frame lost.
. "$VM/guest/common.sh"

# recording NAME SOURCE FAULTS EVENT...: records while the function FAULTS does things to the device; ended as by Ctrl-C
recording() {
  local name=$1 source=$2 faults=$3 out=recorded_$3
  shift 3
  timeout --kill-after=100 200 "$HEARTSERVO" capture "$source" --quiet --out $out >/tmp/out 2>/tmp/err &
  local job=$!
  until_there $out.partial/frames.csv 40 || echo "FAIL $name: does not start: $(cat /tmp/err)"
  sleep 1
  $faults
  kill -TERM $job
  wait $job
  local code=$?
  [ $code -eq 130 ] || { echo "FAIL $name: ended with $code: $(cat /tmp/err)"; return; }
  says "$name, recording" $out/summary.json "$@"
  local rows=$(($(wc -l <$out/frames.csv) - 1))
  says "$name, none of $rows recorded frames lost" $out/summary.json "\"frames\": $rows," '"failure": null'
}

# servoing NAME SOURCE FAULTS EVENT...: the same while the loop runs on the picture; a safety stop (5) may end it
servoing() {
  local name=$1 source=$2 faults=$3 out=servo_$3
  shift 3
  timeout --kill-after=100 200 "$HEARTSERVO" servo "v4l2:$source" --roi 200,160,100,100 --settle-s 0 --quiet --out $out >/tmp/out 2>/tmp/err &
  local job=$!
  until_there $out.partial 40 || echo "FAIL $name: does not start: $(cat /tmp/err)"
  sleep 1
  $faults
  kill -TERM $job
  wait $job
  local code=$?
  [ $code -eq 130 ] || [ $code -eq 5 ] || { echo "FAIL $name: ended with $code: $(cat /tmp/err)"; return; }
  says "$name, servoing ($(wc -l <$out/frames.csv) rows, ended with $code)" $out/summary.json "$@" '"age_ms"'
}

webcam_faults() {
  control inject_v4l2_buf_flag_error=1; sleep 1
  control percentage_of_dropped_buffers=60; sleep 1; control percentage_of_dropped_buffers=0; sleep 0.5
  control inject_fatal_streaming_error=1; sleep 1.5
  control osd_text_mode=2; sleep 2; control osd_text_mode=0; sleep 0.7
  control disconnect=1; sleep 2.5
}
hdmi_faults() {
  for mode in 1 2 3; do control dv_timings_signal_mode=$mode; sleep 1.2; control dv_timings_signal_mode=0; sleep 1; done
  control dv_timings=2; control dv_timings_signal_mode=4; sleep 2.5  # 720x480p59
  control dv_timings=0; sleep 2.5
}
sequence_wrap() { control wrap_sequence_number=1; control inject_fatal_streaming_error=1; sleep 3; }
time_wrap() { control wrap_timestamp=2; control inject_fatal_streaming_error=1; sleep 3; }

webcam=/dev/video0,size=320x180
hdmi=/dev/video0,input=HDMI
of_webcam=('"bad_buffer": ' '"sequence_gap": ' '"stream_error": ' '"restarted": ' '"frozen_picture": ' '"picture_moves": '
           '"disconnected": 1' '"reopened": 1' '"recovered": ')
of_hdmi=('"no_signal": 1' '"no_lock": 1' '"out_of_range": 1' '"signal_back": 3' '"resolution_changed": 2' 'from 640x480p 59'
         'to 720x480p 59' '"recovered": ')
# coloured squares have corners to follow
fresh_webcam() { vivid node_types=0x1 num_inputs=1 input_types=0x0; control test_pattern=4; }
fresh_hdmi() {
  vivid node_types=0x1 num_inputs=1 input_types=0x3
  timeout 10 v4l2-ctl -d /dev/video0 --set-dv-bt-timings index=0 >/dev/null
  control test_pattern=4
}

fresh_webcam; recording "webcam" $webcam webcam_faults "${of_webcam[@]}"
fresh_webcam; servoing "webcam" /dev/video0,size=640x480 webcam_faults "${of_webcam[@]}"
fresh_hdmi; recording "HDMI" $hdmi hdmi_faults "${of_hdmi[@]}"
fresh_hdmi; servoing "HDMI" $hdmi hdmi_faults "${of_hdmi[@]}"
fresh_webcam; recording "a count that wraps" $webcam sequence_wrap '"stream_error": ' '"recovered": '
fresh_webcam; recording "a time that wraps" $webcam time_wrap '"stream_error": ' '"recovered": '
