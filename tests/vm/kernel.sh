#!/usr/bin/env bash
# kernel.sh: fetches a Debian kernel with camera drivers, once, and prints two lines: the folder it was unpacked in, and
# its version. It is kept in $HEARTSERVO_VM_CACHE, or ~/.cache/heartservo-vm. Ends with 77 and a line that says why when
# it cannot be had.
set -euo pipefail

cache=${HEARTSERVO_VM_CACHE:-${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/heartservo-vm}
skip() { echo "SKIPPED: $*" >&2; exit 77; }

mkdir -p "$cache" || skip "$cache cannot be made; set HEARTSERVO_VM_CACHE"
exec 9>"$cache/lock"
flock 9

# one that is there already
for folder in "$cache"/linux-image-*/; do
  [[ -e $folder/ready ]] && { echo "$folder"; cat "$folder/ready"; exit 0; }
done

for tool in apt-cache apt-get dpkg depmod; do
  command -v "$tool" >/dev/null || skip "$tool is missing (tools/setup/install.sh --vm)"
done
# 6.12 where it is to be had: 6.1 sometimes counts two frames by one number. Not the cloud kernel: it has no cameras.
package=$(apt-cache search --names-only '^linux-image-6\.12\.[0-9.+a-z]*-amd64$' | awk '{print $1}' |
          grep -v -e cloud -e -rt- | sort -V | tail -1)
[[ -n $package ]] || package=$(apt-cache depends linux-image-amd64 2>/dev/null | awk '/Depends:/{print $2; exit}')
[[ -n $package ]] || skip "apt knows no kernel (apt-get update?)"
version=${package#linux-image-}
cd "$cache"
if ! timeout 300 apt-get download "$package" >download.log 2>&1; then
  skip "the kernel package $package cannot be fetched: $(tail -1 download.log)"
fi
rm -rf "$package"
dpkg -x "${package}"_*.deb "$package"
rm -f "${package}"_*.deb
depmod -b "$cache/$package" "$version"
echo "$version" >"$package/ready"
echo "$cache/$package/"
echo "$version"
