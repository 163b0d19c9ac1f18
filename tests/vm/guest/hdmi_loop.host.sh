# hdmi_loop.host.sh PROGRAM: what hdmi_loop.sh sends.
set -euo pipefail
. "$(dirname "$0")/pictures.sh" "$1"
"$build/tests/vm/recording_check" raw "$pictures" "$made/frames.raw" 640 480 300 >"$made/count"
echo "to be sent: $(cat "$made/count") pictures of $pictures"
