#!/usr/bin/env bash
# install.sh [--tests] [--vm]: installs what heartservo is built from (packages.txt), with --tests also what its tests
# use, with --vm what those in a virtual machine use. Returns at once when everything is there.
set -euo pipefail

list=$(dirname "$(readlink -f "$0")")/packages.txt
with_tests=0 with_vm=0
for argument in "$@"; do
  case $argument in
    --tests) with_tests=1 ;;
    --vm) with_vm=1 ;;
    *) echo "install.sh: unknown option '$argument'; there are --tests and --vm" >&2; exit 2 ;;
  esac
done

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "install.sh: this is not Debian; install the libraries in $list by hand" >&2
  exit 2
fi

mapfile -t packages < <(awk -v tests="$with_tests" -v vm="$with_vm" '
  /^\[tests\]/ { left_out = !tests; next }
  /^\[vm\]/ { left_out = !vm; next }
  { sub(/#.*/, "") }
  NF && !left_out { print $1 }' "$list")

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
if [[ ${#missing[@]} -eq 0 ]]; then
  echo "All ${#packages[@]} packages are installed."
  exit 0
fi

echo "Missing: ${missing[*]}"
as_root=()
if [[ $(id -u) -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "install.sh: needs root or sudo; as root run: apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 2
  fi
  as_root=(sudo)
fi
"${as_root[@]}" apt-get update
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"
