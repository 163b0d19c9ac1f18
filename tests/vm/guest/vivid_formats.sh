# Every format, input and option of capture on vivid, and what it refuses.
. "$VM/guest/common.sh"

check "no device, list" 60 "$HEARTSERVO" capture --list
says "no device, list says so" /tmp/out "no video device"
refused "no device, capture" 4 "/dev/video9: cannot be opened" "$HEARTSERVO" capture /dev/video9

vivid node_types=0x1 num_inputs=3 input_types=0x38  # webcam, S-Video, HDMI
check "list" 60 "$HEARTSERVO" capture --list
says "list shows inputs and formats" /tmp/out "vivid" "input 0  Webcam" "input 1  S-Video" "input 2  HDMI" "YUYV" "NV12" "GREY" "at .* Hz"
check "list as JSON" 60 "$HEARTSERVO" capture --list --json
says "JSON" /tmp/out '"devices"' '"decoded_by": "heartservo"'

control test_pattern=7  # red
control osd_text_mode=2
for format in YUYV UYVY NV12 YU12 RGB3 BGR3; do
  check "$format is captured" 60 "$HEARTSERVO" capture "/dev/video0,format=$format,size=320x180,frozen-s=0" --frames 5 --png --out $format
  check "$format is red" 30 "$CHECK" colour $format 0 0 255 4
done
control test_pattern=6  # white
check "GREY is captured" 60 "$HEARTSERVO" capture /dev/video0,format=GREY,size=320x180,frozen-s=0 --frames 5 --out GREY
check "GREY is white" 60 "$CHECK" colour GREY 255 255 255 22
control test_pattern=0
control osd_text_mode=0
check "FFV1" 60 "$HEARTSERVO" capture /dev/video0,size=320x180 --frames 20 --out FFV1
says "what was wanted, granted, measured" FFV1/summary.json '"wanted": "any format 320x180"' '"format": "YUYV 320x180 at' '"rate_hz": [1-9]' '"frames": 20'
check "a recording is a source" 120 "$HEARTSERVO" track FFV1 --roi 10,10,100,60 --json --quiet --out tracked
says "its frames" /tmp/out '"frames": 20'

check "controls are set" 60 "$HEARTSERVO" capture /dev/video0,size=320x180,brightness=200,gain_automatic=0 --frames 3 --out controls
says "and recorded" controls/summary.json '"brightness=200"' '"gain_automatic=0"'
refused "a control that is not there" 2 "did you mean 'brightness'" "$HEARTSERVO" capture /dev/video0,brigtness=3
refused "an input that is not there" 2 "it has 0 (Webcam" "$HEARTSERVO" capture /dev/video0,input=SDI
check "a crop" 60 "$HEARTSERVO" capture /dev/video0,size=320x180,crop=40:20:200:100 --frames 3 --out crop
says "its size" crop/summary.json "to 200x100"
refused "no round picture" 4 "no bright disc" "$HEARTSERVO" capture /dev/video0,size=320x180,crop=round

check "S-Video, interlaced" 90 "$HEARTSERVO" capture /dev/video0,input=S-Video --frames 5 --out interlaced
says "and says so" interlaced/summary.json "interlaced"
refused "interlaced refused" 4 "fields=refuse" "$HEARTSERVO" capture /dev/video0,input=S-Video,fields=refuse

control dv_timings=0 2>/dev/null
timeout 10 v4l2-ctl -d /dev/video0 -i 2 --set-dv-bt-timings index=0 >/dev/null
check "HDMI" 60 "$HEARTSERVO" capture /dev/video0,input=HDMI,format=YUYV --frames 10 --out hdmi
says "its timings" hdmi/summary.json '"timings": "640x480p 59' '"input": "HDMI'
timeout 10 v4l2-ctl -d /dev/video0 -i 2 >/dev/null
interlaced=$(timeout 20 v4l2-ctl -d /dev/video0 --list-dv-timings |
  awk '/Index:/ {i = $2} /Active width:/ {w = $3} /Frame format: interlaced/ && w == 1920 {print i; exit}')
timeout 10 v4l2-ctl -d /dev/video0 --set-dv-bt-timings index=$interlaced >/dev/null
check "HDMI, single fields" 90 "$HEARTSERVO" capture /dev/video0,input=HDMI,format=YUYV --grey --frames 3 --out fields
says "of whole height" fields/summary.json "1920x1080.*single fields" '"timings": "1920x1080i'

check "probe" 120 "$HEARTSERVO" capture --probe /dev/video0,size=320x180,input=0 --seconds 0.5
says "what it measures" /tmp/out "YUYV .*320x180" "MJPG|BGR3" "brightness .* 0 to 255"

mkdir -p small; mount -t tmpfs -o size=24m small small
timeout 10 v4l2-ctl -d /dev/video0 -i 0 >/dev/null
control test_pattern=21  # noise, which no PNG makes smaller
timeout 120 "$HEARTSERVO" capture /dev/video0,size=320x180,rate=15,input=0 --png --out small/full --frames 1000 >/tmp/out 2>/tmp/err
code=$?
if [ $code -eq 2 ] && grep -q "is full" /tmp/err; then echo "PASS a full disk: $(cut -c1-200 /tmp/err)"; else echo "FAIL a full disk: $code $(cat /tmp/err)"; fi
rows=$(($(wc -l <small/full/frames.csv) - 1))
pictures=$(ls small/full/pictures | wc -l)
[ "$rows" -eq "$pictures" ] && [ "$rows" -gt 5 ] && echo "PASS all $rows pictures have a row" || echo "FAIL $rows rows, $pictures pictures"
says "its summary" small/full/summary.json "is full"
