# A Slurm cluster of its own on this machine, to be sourced: cluster_start FOLDER, cluster_kill NODE, cluster_stop. A
# controller and two node daemons, n1 and n2, one core each, on ports that are free; nothing outside FOLDER (no space in its
# name) is touched. As root or as a user.

export PATH=$PATH:/usr/sbin:/sbin

# Says which package is missing, and fails.
cluster_possible() {
  local tool
  for tool in munged:munge slurmctld:slurmctld slurmd:slurmd sbatch:slurm-client; do
    command -v "${tool%:*}" >/dev/null || { echo "${tool#*:} is not installed (tools/setup/install.sh --tests)"; return 1; }
  done
}

free_port() {
  local port
  while :; do
    port=$((20000 + RANDOM % 12000))
    (: </dev/tcp/127.0.0.1/$port) 2>/dev/null || { echo $port; return; }
  done
}

cluster_start() {
  cluster=$1
  local user host node
  user=$(id -un) host=$(hostname -s)
  mkdir -p "$cluster/state"
  export SLURM_CONF=$cluster/slurm.conf
  dd if=/dev/urandom of="$cluster/munge.key" bs=128 count=1 status=none
  chmod 600 "$cluster/munge.key"
  # The waits are short (a node that is silent for 3 s is down; a job of it begins again after 6 s more), and the nodes
  # look after processes by /proc alone: no control groups.
  cat >"$cluster/slurm.conf" <<CONF
ClusterName=heartservo
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$cluster/munge.sock,cred_expire=6
SlurmctldPort=$(free_port)
SlurmctldPidFile=$cluster/slurmctld.pid
SlurmctldLogFile=$cluster/slurmctld.log
StateSaveLocation=$cluster/state
SlurmdPidFile=$cluster/slurmd-%n.pid
SlurmdLogFile=$cluster/slurmd-%n.log
SlurmdSpoolDir=$cluster/spool-%n
SlurmdParameters=config_overrides
SlurmdTimeout=3
MessageTimeout=5
KillWait=1
ReturnToService=2
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,bf_interval=1,batch_sched_delay=0
NodeName=n1 NodeAddr=127.0.0.1 NodeHostname=$host Port=$(free_port) CPUs=1
NodeName=n2 NodeAddr=127.0.0.1 NodeHostname=$host Port=$(free_port) CPUs=1
PartitionName=all Nodes=ALL Default=YES State=UP
CONF
  echo "CgroupPlugin=cgroup/v1" >"$cluster/cgroup.conf" # the one that asks for nothing when it is not used
  munged --force --num-threads=2 --key-file="$cluster/munge.key" --socket="$cluster/munge.sock" \
    --pid-file="$cluster/munged.pid" --log-file="$cluster/munged.log" --seed-file="$cluster/munge.seed"
  slurmctld -f "$SLURM_CONF"
  for node in n1 n2; do cluster_node $node; done
}

# Starts a node's daemon and waits until it is counted on.
cluster_node() {
  mkdir -p "$cluster/spool-$1"
  slurmd -N "$1" -f "$SLURM_CONF"
  local i
  for ((i = 0; i < 100; ++i)); do
    [[ $(sinfo --noheader --nodes="$1" --format=%t 2>/dev/null) == idle ]] && return
    sleep 0.1
  done
  echo "node $1 did not come up"
  return 1
}

# Process ids of the jobs on a node and of Slurm's keepers of them; of all nodes without a name.
cluster_jobs() {
  local process parent
  for process in /proc/[0-9]*; do
    grep -qzx "SLURM_CONF=$SLURM_CONF" "$process/environ" 2>/dev/null || continue
    grep -qz "^SLURMD_NODENAME=${1:-}" "$process/environ" 2>/dev/null || continue
    echo "${process#/proc/}"
    parent=$(awk '/^PPid:/ {print $2}' "$process/status" 2>/dev/null) || continue
    [[ $(cat "/proc/$parent/comm" 2>/dev/null) != slurmstepd ]] || echo "$parent"
  done | sort -u
}

# As when a node's power fails.
cluster_kill() {
  local pids
  pids="$(cat "$cluster/slurmd-$1.pid") $(cluster_jobs "$1")"
  kill -9 $pids 2>/dev/null || true
}

cluster_stop() {
  [[ -n ${cluster:-} ]] || return 0
  local name
  kill -9 $(cluster_jobs) 2>/dev/null || true
  for name in slurmd-n1 slurmd-n2 slurmctld munged; do
    [[ ! -s $cluster/$name.pid ]] || kill -9 "$(cat "$cluster/$name.pid")" 2>/dev/null || true
  done
}
