# Recorded pictures of a heart through vivid's HDMI output into its HDMI input: what is captured is what was sent, bit for
# bit, and is tracked as from files.
. "$VM/guest/common.sh"

vivid node_types=0x101 num_inputs=1 input_types=0x3 num_outputs=1 output_types=0x1
timeout 10 v4l2-ctl -d /dev/video0 --set-dv-bt-timings index=0 >/dev/null
timeout 10 v4l2-ctl -d /dev/video1 --set-dv-bt-timings index=0 >/dev/null
timeout 10 v4l2-ctl -d /dev/video1 --set-fmt-video-out=width=640,height=480,pixelformat=GREY >/dev/null || echo "FAIL GREY output"
timeout 10 v4l2-ctl -d /dev/video0 -c hdmi_000_0_is_connected_to=2 2>/dev/null ||
  timeout 10 v4l2-ctl -d /dev/video1 -c loop_video=1 || echo "FAIL the loop cannot be closed"
source=/dev/video0,format=GREY,frozen-s=0,frames=every
count=$(cat $MADE/count)
bytes=$((640 * 480))

# send FLAG: the first picture again and again until FLAG is there, then all, then the last for a while
send() {
  {
    until [ -e "$1" ]; do head -c $bytes $MADE/frames.raw; done
    cat $MADE/frames.raw
    for _ in $(seq 60); do tail -c $bytes $MADE/frames.raw; done
  } | timeout 150 v4l2-ctl -d /dev/video1 --stream-out-mmap=4 --stream-from=- >/dev/null 2>&1
}

send rec.partial/frames.csv &
sender=$!
sleep 2
check "recording" 120 "$HEARTSERVO" capture $source --frames $((count + 60)) --quiet --out rec
wait $sender
check "bit for bit" 60 "$CHECK" frames rec $MADE/frames.raw 640 480 $((count * 8 / 10))
says "nothing was dropped by us" rec/summary.json '"queue_dropped": 0' '"dropped": 0'
check "tracked from the recording" 150 "$HEARTSERVO" track rec --roi "$(cat $MADE/roi)" --quiet --out from_files

send live.partial &
sender=$!
sleep 2
check "tracked live" 150 "$HEARTSERVO" track v4l2:$source --roi "$(cat $MADE/roi)" --frames $((count + 30)) --quiet --out live
wait $sender
says "the age of frames is known" live/frames.csv "frame/age_s"
check "the same track" 120 "$CHECK" track live/frames.csv from_files/frames.csv
