# usb_camera.host.sh PROGRAM: what the USB camera sends as MJPEG.
set -euo pipefail
. "$(dirname "$0")/pictures.sh" "$1"
mkdir -p "$made/jpeg"
echo "JPEGs: $("$build/tests/vm/recording_check" jpegs "$pictures" "$made/jpeg" 640 480 60) pictures of $pictures"
