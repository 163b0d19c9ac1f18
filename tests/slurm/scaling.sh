#!/usr/bin/env bash
# scaling.sh PROGRAM SCENE [RUNS]: by hand; how many runs a second a sweep does with one and two jobs, and on a Slurm cluster
# with one and two node daemons; what a run costs beside its frames; and the memory of the sweep over RUNS runs (300) of two
# frames with a coarse texture. On a machine that does nothing else.
set -euo pipefail

here=$(dirname "$(readlink -f "$0")")
program=$(readlink -f "$1") scene=$(readlink -f "$2") runs=${3:-300}
source "$here/cluster.sh"
work=$(mktemp -d)
trap 'cluster_stop; rm -rf "$work"' EXIT
cd "$work"

# sweep_file NAME FRAMES RUNS
sweep_file() {
  cat >"$1.yaml" <<SWEEP
scene: $scene
set: {duration_s: $(awk "BEGIN {print $2 / 125}"), settle_s: 0, picture.texture.size: 256}
axes: {seed: {from: 1, to: $3}}
metrics: [residual.rms_mm]
SWEEP
}
now() { date +%s.%N; }
since() { awk "BEGIN {print $(now) - $1}"; }
rate() { awk "BEGIN {printf \"%.2f runs/s (%d runs in %.1f s)\n\", $1 / $2, $1, $2}"; }

sweep_file tiny 2 "$runs"
sweep_file short 100 24

echo "== what a run of two frames costs, all told; memory of the sweep itself"
while [[ ! -e ended ]]; do
  sweep=$(pgrep -o -f -- "sweep tiny.yaml --out tiny" || true)
  echo "$(($(cat tiny/runs.csv 2>/dev/null | wc -l) - 1)) $(awk '/^VmRSS/ {print $2}' "/proc/$sweep/status" 2>/dev/null)"
  sleep 0.2
done | awk 'NF == 2 && $1 >= 0' >memory &
begin=$(now)
TIMEFORMAT='%U %S'
{ time "$program" sweep tiny.yaml --out tiny --jobs 1 --quiet; } 2>cpu
took=$(since "$begin")
touch ended
wait
awk "{printf \"%.1f ms a run, %.1f ms of a processor\\n\", 1e3 * $took / $runs, 1e3 * (\$1 + \$2) / $runs}" cpu
awk 'NR == 1 || $1 >= next_ {print "after " $1 " runs: " $2 " kB"; next_ = $1 + '$((runs / 5))'}
     END {print "after " $1 " runs: " $2 " kB"}' memory

for jobs in 1 2; do
  begin=$(now)
  { time "$program" sweep short.yaml --out "jobs-$jobs" --jobs $jobs --quiet; } 2>cpu
  echo "--jobs $jobs: $(rate 24 "$(since "$begin")"), $(awk '{print $1 + $2}' cpu) s of processors"
done
cluster_possible || exit 0
mkdir cluster
cluster_start "$work/cluster"
for nodes in n1 n1,n2; do
  begin=$(now)
  options=--comment=scaling
  [[ $nodes == n1,n2 ]] || options=--nodelist=n1
  "$program" sweep short.yaml --out "nodes-$nodes" --tasks 4 --slurm=$options --quiet
  while [[ -n $(squeue --noheader) ]]; do sleep 0.2; done
  echo "nodes $nodes: $(rate 24 "$(since "$begin")")"
done
