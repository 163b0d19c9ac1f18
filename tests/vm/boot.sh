#!/usr/bin/env bash
# boot.sh SCRIPT PROGRAM SECONDS MODULE...: boots a Debian kernel in QEMU (emulated where there is no KVM), with the
# machine's own file system to read, loads nothing but the modules' files, and runs SCRIPT there as root, with PROGRAM in
# $HEARTSERVO. SCRIPT says "PASS name" or "FAIL name: why" for every check. Ends with 0 when all passed, 77 when it cannot
# run here. Everything is under a time limit.
set -euo pipefail

here=$(dirname "$(readlink -f "$0")")
script=$(readlink -f "$1") program=$(readlink -f "$2") seconds=$3
shift 3
skip() { echo "SKIPPED: $*"; exit 77; }

for tool in qemu-system-x86_64 cpio modprobe depmod xz v4l2-ctl; do
  PATH=$PATH:/sbin:/usr/sbin command -v "$tool" >/dev/null || skip "$tool is missing (tools/setup/install.sh --vm)"
done
export PATH=$PATH:/sbin:/usr/sbin
[[ -x /bin/busybox ]] && ! ldd /bin/busybox >/dev/null 2>&1 || skip "busybox-static is missing (tools/setup/install.sh --vm)"

if kernel=$("$here/kernel.sh" 2>"${TMPDIR:-/tmp}/heartservo-kernel.$$"); then
  rm -f "${TMPDIR:-/tmp}/heartservo-kernel.$$"
else
  code=$?
  cat "${TMPDIR:-/tmp}/heartservo-kernel.$$"; rm -f "${TMPDIR:-/tmp}/heartservo-kernel.$$"
  exit "$code"
fi
{ read -r folder; read -r version; } <<<"$kernel"

accel_text=$("$here/accel.sh" "$folder/boot/vmlinuz-$version") || exit $?
read -r -a accel <<<"$accel_text"

if [[ -e ${script%.sh}.host.sh ]]; then bash "${script%.sh}.host.sh" "$program"; fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
root=$work/root
mkdir -p "$root"/{bin,proc,sys,dev,host} "$root/lib/modules/$version"
cp /bin/busybox "$root/bin/"
for module in 9p 9pnet_virtio virtio_pci overlay "$@"; do
  modprobe -d "$folder" -S "$version" --show-depends "$module" | awk '$1 == "insmod" {print $2}'
done | sort -u | while read -r file; do
  to=$root/lib/modules/${file##*/lib/modules/}
  mkdir -p "${to%/*}"
  cp "$file" "$to"
  case $to in *.xz) xz -d "$to" ;; esac
done
cp "$folder/lib/modules/$version/"modules.{builtin,builtin.modinfo,order} "$root/lib/modules/$version/"
depmod -b "$root" "$version"

cat >"$root/init" <<INIT
#!/bin/busybox sh
/bin/busybox --install -s /bin
export PATH=/bin
mount -t proc proc /proc; mount -t sysfs sys /sys; mount -t devtmpfs dev /dev
modprobe virtio_pci; modprobe 9pnet_virtio; modprobe 9p; modprobe overlay
mount -t tmpfs -o size=700m tmp /host; mkdir -p /host/lower /host/upper /host/work /host/all
mount -t 9p -o trans=virtio,version=9p2000.L,msize=512000,cache=loose,ro host /host/lower || echo "FAIL boot: no file system"
mount -t overlay -o lowerdir=/host/lower,upperdir=/host/upper,workdir=/host/work overlay /host/all
for d in dev proc sys; do mount -o bind /\$d /host/all/\$d; done
mkdir -p /host/all/dev/shm /host/all/tmp; mount -t tmpfs tmp /host/all/tmp
mount -t debugfs none /host/all/sys/kernel/debug 2>/dev/null
mkdir -p /host/all/lib/modules; mount -t tmpfs m /host/all/usr/lib/modules 2>/dev/null
cp -r /lib/modules/$version /host/all/lib/modules/
cd /
chroot /host/all /usr/bin/env PATH=/usr/bin:/bin:/usr/sbin:/sbin HOME=/tmp HEARTSERVO='$program' VM='$here' DATA='${HEARTSERVO_DATA:-}' \
  /bin/bash '$script'
echo "GUEST-ENDED \$?"
poweroff -f
INIT
chmod +x "$root/init"
(cd "$root" && find . -print0 | cpio -0 -o -H newc --quiet) >"$work/initrd"

echo "the machine: ${accel[*]}"
status=0
timeout --kill-after=10 "$seconds" qemu-system-x86_64 -M q35 "${accel[@]}" -smp 2 -m 2048 \
  -nodefaults -no-user-config -display none -serial stdio -no-reboot \
  -virtfs local,path=/,mount_tag=host,security_model=none,readonly=on,multidevs=remap \
  -kernel "$folder/boot/vmlinuz-$version" -initrd "$work/initrd" \
  -append "console=ttyS0 quiet panic=-1 mitigations=off" </dev/null | sed -u 's/\r//' | tee "$work/log" || status=$?

[[ $status -eq 0 ]] || { echo "FAILED: the virtual machine did not end within $seconds s"; exit 1; }
grep -q '^GUEST-ENDED 0' "$work/log" || { echo "FAILED: the script in the guest did not end well"; exit 1; }
! grep -q '^FAIL' "$work/log" || { echo "FAILED: $(grep -c '^FAIL' "$work/log") checks"; exit 1; }
grep -q '^PASS' "$work/log" || { echo "FAILED: nothing was checked"; exit 1; }
echo "$(grep -c '^PASS' "$work/log") checks passed"
