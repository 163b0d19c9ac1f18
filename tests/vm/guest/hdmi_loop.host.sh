# hdmi_loop.host.sh PROGRAM: what hdmi_loop.sh sends, and how it is tracked in the files. The camera shows every picture
# several times, and a tracker that sees a picture again comes nearer: so do the files.
set -euo pipefail
. "$(dirname "$0")/pictures.sh" "$1"
"$build/tests/vm/recording_check" raw "$pictures" "$made/frames.raw" 640 480 300 >"$made/sent"
read -r count crop <"$made/sent"
mkdir -p "$made/repeated"
number=0
for picture in $(find "$pictures" -maxdepth 1 -name '*.png' | LC_ALL=C sort | head -n "$count"); do
  for _ in 1 2 3 4; do ln -s "$(realpath "$picture")" "$made/repeated/$(printf %05d $number).png"; number=$((number + 1)); done
done
"$program" track "$made/repeated" --roi "$(cat "$made/roi")" --quiet --out "$made/from_files"
echo "to be sent: $count pictures of $pictures, and of what comes is taken $crop"
