#!/usr/bin/env bash
# accel.sh KERNEL: prints QEMU's options for running the machine: under KVM where that has booted KERNEL here, else emulated.
# That /dev/kvm is there says nothing: nested in other machines it may hang, or run only kernels made for it.
# HEARTSERVO_VM_ACCEL=kvm: ends with 77 where it has not; tcg: emulated without a trial.
set -euo pipefail

kernel=$1
kvm=(-accel kvm -cpu host)
# The guest's clock counts instructions (1 ns each) while it is busy, so that on a machine with other work to do the camera's
# time is as slow as the program, and no frame is lost that would not be lost on an idle one.
# Without "erms": what a processor copies fast by one instruction is emulated byte by byte. Without "cx16": QEMU 7.2 leaves
# wrong flags behind that instruction, and an interrupt right after it crashes the kernel.
tcg=(-accel tcg,thread=single,tb-size=512 -icount shift=0 -cpu max,-erms,-cx16)

usable() {
  [[ -w /dev/kvm ]] && grep -qwE 'vmx|svm' /proc/cpuinfo || return 1
  local work
  work=$(mktemp -d)
  trap 'rm -rf "$work"' RETURN
  mkdir "$work/root" "$work/root/bin"
  cp /bin/busybox "$work/root/bin/"
  printf '#!/bin/busybox sh\n/bin/busybox echo IT-BOOTS\n/bin/busybox poweroff -f\n' >"$work/root/init"
  chmod +x "$work/root/init"
  (cd "$work/root" && find . -print0 | cpio -0 -o -H newc --quiet) >"$work/initrd"
  timeout --kill-after=5 15 qemu-system-x86_64 -M q35 "${kvm[@]}" -smp 2 -m 512 -nodefaults -no-user-config -display none \
    -serial stdio -no-reboot -kernel "$kernel" -initrd "$work/initrd" -append "console=ttyS0 quiet panic=-1" \
    </dev/null >"$work/log" 2>&1 && grep -q IT-BOOTS "$work/log"
}

case ${HEARTSERVO_VM_ACCEL:-} in
  tcg) echo "${tcg[@]}" ;;
  kvm) usable && echo "${kvm[@]}" || { echo "SKIPPED: KVM does not run it here" >&2; exit 77; } ;;
  *) usable && echo "${kvm[@]}" || echo "${tcg[@]}" ;;
esac
