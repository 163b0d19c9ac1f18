#!/usr/bin/env bash
# Installs what is missing, builds heartservo and runs its demonstration: the loop on the simulated heart of the paper.
# The result is runs/demo; open runs/demo/report.html. Options are handed to `heartservo servo`.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")"

tools/setup/install.sh
cmake --preset release
cmake --build --preset release --target heartservo
build/release/heartservo servo scenes/pig_2007.yaml --out runs/demo "$@"
echo
echo "The report: file://$PWD/runs/demo/report.html"
