#!/usr/bin/env bash
# chroot.sh BUILD [BASE]: makes the Debian package of a build, installs it in a clean Debian 12 and runs it there, as root.
# BASE: a folder that debootstrap has filled already (it is not changed); else one is made, some 50 MB of downloads.
# With its dependencies the package downloads some 170 MB more. It takes 45 s of processor time, and minutes of network and
# disk: no test of ctest's. Ends with 77, and says why, where it cannot be tried.
set -euo pipefail
mirror=${DEBIAN_MIRROR:-http://deb.debian.org/debian}
skip() { echo "chroot.sh: skipped: $1"; exit 77; }
[[ $# -ge 1 ]] || { echo "usage: chroot.sh BUILD [BASE]" >&2; exit 2; }
build=$(readlink -f "$1") base=${2:+$(readlink -f "$2")}
[[ $(id -u) -eq 0 ]] || skip "needs root"
command -v debootstrap >/dev/null || [[ -n $base ]] || skip "debootstrap is missing; apt-get install debootstrap"
wget -q --spider --timeout=15 --tries=1 "$mirror/dists/bookworm/Release" || skip "$mirror cannot be reached"

place=$(mktemp -d /var/tmp/heartservo-chroot-XXXXXX)
trap 'rm -rf --one-file-system "$place"' EXIT
took() { echo "$1: $((SECONDS - since)) s"; since=$SECONDS; }
since=$SECONDS

(cd "$build" && cpack -B "$place/package" >"$place/cpack.log") || { cat "$place/cpack.log"; exit 1; }
package=$(ls "$place"/package/*.deb)
took "package made"

root=$place/root
if [[ -n $base ]]; then
  cp -a "$base" "$root"
else
  debootstrap --variant=minbase bookworm "$root" "$mirror" >"$place/debootstrap.log" ||
    { tail "$place/debootstrap.log"; exit 1; }
fi
took "clean Debian 12 there"

cp "$package" "$root/heartservo.deb"
cp /etc/resolv.conf "$root/etc/resolv.conf"
cat >"$root/try.sh" <<'TRY'
set -eu
export DEBIAN_FRONTEND=noninteractive LC_ALL=C
mount -t proc proc /proc
apt-get -qq update
dpkg -i /heartservo.deb >/dev/null 2>&1 || true  # it lacks its dependencies
apt-get -qq -y --no-install-recommends -f install >/install.log 2>&1 || { tail /install.log; exit 1; }
status=$(dpkg-query -W -f '${db:Status-Status}' heartservo)
[ "$status" = installed ] || { echo "apt-get -f install has removed it instead: $status"; exit 1; }
! ldd /usr/bin/heartservo | grep "not found"
mkdir -p /home/someone && cd /home/someone  # nothing of the sources is here
heartservo --version
heartservo doctor | grep "/usr/share/heartservo/scenes"
heartservo servo scenes/pig_2007.yaml --frames 250 --out run >table
grep residual table
heartservo track scenes/pig_2007.yaml --frames 25 --quiet --out tracked
for file in report.html summary.json frames.csv config.yaml video.webm; do
  [ -s "run/$file" ] || { echo "run/$file is missing"; exit 1; }
done
[ -s /usr/share/bash-completion/completions/heartservo ]
dpkg -r heartservo >/dev/null
[ ! -e /usr/bin/heartservo ] || { echo "dpkg -r leaves the program"; exit 1; }
TRY
unshare --mount chroot "$root" /bin/sh /try.sh || { echo "chroot.sh: failed in the chroot" >&2; exit 1; }
took "installed with its dependencies, run and removed"
echo "the Debian package works"
