# pictures.sh PROGRAM: sets $pictures to what the cameras of the tests show, 300 pictures of a real heart where there are
# any, else of the simulated one, and $made to where things for the guest go; writes the region to track there.
program=$1
build=$(dirname "$program")
made=$build/tests/vm/made/$(basename "$0" .host.sh)
vm=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
rm -rf "$made"
mkdir -p "$made"
pictures=${HEARTSERVO_DATA:-$vm/../../../shared/data}/heart_invivo/left
if [[ -d $pictures ]]; then
  echo 150,130,60,60 >"$made/roi"
else
  "$program" render "$vm/../../scenes/pig_2007.yaml" --frames 125 --quiet --out "$made/rendered"
  pictures=$made/rendered/frames
  echo 229,221,60,60 >"$made/roi"
fi
