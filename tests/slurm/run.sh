#!/usr/bin/env bash
# run.sh PROGRAM SCENE: a sweep on a real Slurm gives what it gives without, to the last digit: whole, and with a node that
# dies in the middle. Ends with 77 when Slurm cannot be had here.
set -euo pipefail

here=$(dirname "$(readlink -f "$0")")
program=$(readlink -f "$1") scene=$(readlink -f "$2")
source "$here/cluster.sh"
missing=$(cluster_possible) || { echo "SKIPPED: $missing"; exit 77; }

work=$(mktemp -d)
end() {
  local code=$?
  if [[ $code -ne 0 ]]; then
    tail -n 25 "$work"/cluster/*.log "$work"/*/slurm/*.log 2>/dev/null || true
    squeue --array 2>/dev/null || true
    echo "FAILED ($code)"
  fi
  cluster_stop
  rm -rf "$work"
}
trap end EXIT
trap 'exit 1' INT TERM
cd "$work"

fail() { echo "FAILED: $*"; exit 1; }

# results.csv without what differs from run to run: its columns seconds and error come last
numbers() { awk -F, -v OFS=, '{NF -= 2; print}' "$1/results.csv"; }

# waits until no job is left
ended() {
  local i
  for ((i = 0; i < ${1:-900}; ++i)); do
    [[ -n $(squeue --noheader) ]] || return 0
    sleep 0.1
  done
  fail "jobs are left after $((${1:-900} / 10)) s"
}

cat >sweep.yaml <<SWEEP
scene: $scene
set: {duration_s: 0.4, settle_s: 0.1}
axes:
  engines.predictor: [hold, constant_velocity]
  latency_ms: [16, 32]
  seed: {from: 1, to: 3}
metrics: [residual.rms_mm, residual.max_mm, tracking.lost_frames]
SWEEP

mkdir cluster
cluster_start "$work/cluster"
"$program" sweep sweep.yaml --out local --quiet
[[ $(wc -l <local/results.csv) -eq 13 ]] || fail "the local sweep is not whole"

echo "== as a job array, into a folder with a space, with options of sbatch"
"$program" sweep sweep.yaml --out "on the cluster" --tasks 4 --slurm="--nice=5 --comment='a test'"
if "$program" sweep sweep.yaml --out "on the cluster" --slurm 2>refusal; then fail "submitted twice"; fi
grep -q "still at this sweep" refusal || fail "the second submission: $(cat refusal)"
ended
diff <(numbers local) <(numbers "on the cluster") || fail "the cluster's numbers are others"
[[ $(ls "on the cluster"/runs-*.csv | wc -l) -eq 4 ]] || fail "not four shares"
[[ -s "on the cluster/report.html" ]] || fail "no report"

echo "== a node dies in the middle"
job=$("$program" sweep sweep.yaml --out killed --tasks 2 --slurm --json | awk -F'"' '/array_job/ {print $4}')
share=
for ((i = 0; i < 300; ++i)); do
  share=$(squeue --noheader --array --nodelist=n1 --format=%K)
  [[ -z $share || $(cat "killed/runs-$share.csv" 2>/dev/null | wc -l) -lt 3 ]] || break
  sleep 0.1
done
[[ $i -lt 300 ]] || fail "no task came to node n1"
cluster_kill n1
before=$(($(wc -l <"killed/runs-$share.csv") - 1))
[[ $before -lt 6 ]] || fail "share $share had ended before its node was killed"
ended
diff <(numbers local) <(numbers killed) || fail "after the node's death the numbers are others"
restarts=$(scontrol show job "${job}_$share" | grep -o 'Restarts=[0-9]*')
[[ $restarts == Restarts=1 ]] || fail "share $share was not begun again ($restarts)"
[[ $(cut -d, -f1 "killed/runs-$share.csv" | sort | uniq -d | wc -l) -eq 0 ]] || fail "a run of share $share was repeated"
echo "share $share had done $before of 6 runs; the rest was done by the other node"

echo "== a task is ended and later submitted again, alone"
job=$("$program" sweep sweep.yaml --out again --tasks 2 --slurm --json | awk -F'"' '/array_job/ {print $4}')
scancel "${job}_2"
ended
grep -q "6 of 12 runs are done" again/slurm/merge.log || fail "the merge does not say what is missing"
"$program" sweep sweep.yaml --out again --slurm --retry | tee said
grep -q "6 of 12 runs are left, in 1 task (shares 2 of 2)" said || fail "not share 2 alone"
ended
diff <(numbers local) <(numbers again) || fail "after the second submission the numbers are others"

echo "== what the cluster refuses"
if "$program" sweep sweep.yaml --out refused --slurm=--partition=nowhere 2>refusal; then fail "a partition that is not there"; fi
[[ $(wc -l <refusal) -eq 1 ]] && grep -q "sbatch refuses.*partition" refusal || fail "the refusal: $(cat refusal)"
echo "passed after $SECONDS s"
