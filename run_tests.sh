#!/usr/bin/env bash
# run_tests.sh [--sanitizers] [--vm]: installs what is missing, builds heartservo and runs all its tests but those that
# need a virtual machine with camera drivers (label vm). With --vm also those; they are skipped where the virtual machine or
# the kernel cannot be had. With --sanitizers also the unit tests under the address, undefined-behaviour and thread
# sanitizers. Ends with non-zero on any failure, after all steps.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")"

sanitizers=0 vm=0
for argument in "$@"; do
  case $argument in
    --sanitizers) sanitizers=1 ;;
    --vm) vm=1 ;;
    *) echo "run_tests.sh: unknown option '$argument'; there are --sanitizers and --vm" >&2; exit 2 ;;
  esac
done

jobs=$(nproc)
failed=()
under=()  # what the builds and tests run under

# step NAME COMMAND...: runs it under a line that says so; a failure is remembered and fails the script at its end.
step() {
  local name=$1
  shift
  printf '\n==== %s (after %d:%02d)\n' "$name" $((SECONDS / 60)) $((SECONDS % 60))
  if ! "$@"; then
    failed+=("$name")
    return 1
  fi
}

# build PRESET [TARGET...]
build() {
  local preset=$1
  shift
  "${under[@]}" cmake --preset "$preset" && "${under[@]}" cmake --build --preset "$preset" -j "$jobs" ${1:+--target "$@"}
}

# suite PRESET CTEST-OPTION...: ctest counts no tests as success, but there must be some
suite() {
  local preset=$1
  shift
  "${under[@]}" ctest --preset "$preset" -j "$jobs" --no-tests=error "$@"
}

step "Packages" tools/setup/install.sh --tests || exit 1

if step "Build, release" build release; then
  step "Tests, release" suite release -LE vm || true
  if [[ $vm -eq 1 ]]; then
    tools/setup/install.sh --tests --vm || echo "without them the tests in the virtual machine are skipped"
    step "Tests on camera drivers, in a virtual machine" suite release -L vm || true
  fi
fi
if [[ $sanitizers -eq 1 ]]; then
  if step "Build, address and undefined-behaviour sanitizers" build asan unit_tests; then
    step "Unit tests, address and undefined-behaviour sanitizers" suite asan -L unit || true
  fi
  # the thread sanitizer of GCC 12 does not start under the stronger address randomisation of newer kernels
  if setarch -R true 2>/dev/null; then under=(setarch -R); fi
  # only what has threads: the loop, the simulator, the signal handling of the tools
  if step "Build, thread sanitizer" build tsan threaded_unit_tests; then
    step "Unit tests, thread sanitizer" suite tsan -L unit -R '^(servo\.|sim\.Endoscope|tools\.Interrupt)' || true
  fi
fi

printf '\n==== Done after %d:%02d: ' $((SECONDS / 60)) $((SECONDS % 60))
if [[ ${#failed[@]} -gt 0 ]]; then
  printf 'FAILED\n'
  printf '  %s\n' "${failed[@]}"
  exit 1
fi
echo "all passed"
