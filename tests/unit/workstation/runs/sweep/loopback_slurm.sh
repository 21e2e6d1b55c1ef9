# loopback_slurm.sh: sourced. A real Slurm of two nodes on this machine, with a separate munge:
#   start_slurm FOLDER PORT   in FOLDER/slurm, from PORT on; skips the test if it cannot
#   start_slurmctld, start_slurmd NODE, kill_hard NAME   failures and recoveries
#   wait_until SECONDS WHAT COMMAND...   until it succeeds
# Every program that is started here ends with the script, by its process id.
PATH=$PATH:/usr/sbin

skip() {
  echo "SKIPPED: $1"
  exit 77
}

wait_until() {
  seconds=$1 what=$2
  shift 2
  tries=0
  until "$@" >/dev/null 2>&1; do
    tries=$((tries + 1))
    if [ $tries -gt $((seconds * 5)) ]; then
      echo "not within $seconds s: $what"
      squeue || true
      tail -n 5 "$slurm"/*.log || true
      exit 1
    fi
    sleep 0.2
  done
}
nodes_idle() { [ "$(sinfo --noheader --format=%D --states=idle)" = 2 ]; }
queue_is_empty() { waiting=$(squeue --noheader) && [ -z "$waiting" ]; }

start_slurmctld() {
  slurmctld -D -f "$SLURM_CONF" >>"$slurm/slurmctld.txt" 2>&1 &
  echo $! >"$slurm/slurmctld.started"
}
start_slurmd() {
  unshare --uts sh -c "hostname $1; exec slurmd -D -N $1 -f '$SLURM_CONF'" \
    >>"$slurm/$1.txt" 2>&1 &
  echo $! >"$slurm/$1.started"
}
kill_hard() {
  kill -9 "$(cat "$slurm/$1.started")"
  rm "$slurm/$1.started"
}
stop_slurm() {
  for started in "$slurm"/*.started; do
    [ ! -f "$started" ] || kill "$(cat "$started")" 2>/dev/null || true
  done
  wait
}

start_slurm() {
  [ "$(id -u)" = 0 ] || skip "Slurm on loopback needs root"
  for tool in slurmctld slurmd munged sbatch unshare; do
    command -v $tool >/dev/null ||
      skip "no $tool here; tools/setup --test installs slurm-wlm and munge"
  done
  slurm=$1/slurm
  mkdir -p "$slurm/munge" "$slurm/state" "$slurm/spool-n1" "$slurm/spool-n2"
  slurm=$(cd "$slurm" && pwd)
  chmod 755 "$1" "$slurm" "$slurm/munge"
  dd if=/dev/urandom of="$slurm/munge/key" bs=1024 count=1 2>/dev/null
  chmod 400 "$slurm/munge/key"
  trap stop_slurm EXIT
  trap 'exit 1' INT TERM
  munged --foreground --force --key-file="$slurm/munge/key" --socket="$slurm/munge/socket" \
    --pid-file="$slurm/munge/pid" --log-file="$slurm/munge.log" \
    --seed-file="$slurm/munge/seed" >"$slurm/munged.txt" 2>&1 &
  echo $! >"$slurm/munged.started"
  # The minimum for Slurm: no accounting, no cgroups, two nodes by their ports.
  cat >"$slurm/slurm.conf" <<CONF
ClusterName=loopback
SlurmctldHost=localhost(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket=$slurm/munge/socket
SlurmUser=root
SlurmdUser=root
SlurmctldPort=$2
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/slurmd-%n.pid
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool-%n
SlurmctldLogFile=$slurm/slurmctld.log
SlurmdLogFile=$slurm/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
SlurmdTimeout=20
KillWait=5
SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1
NodeName=n1 NodeHostname=n1 NodeAddr=127.0.0.1 Port=$(($2 + 2)) CPUs=1 RealMemory=2000
NodeName=n2 NodeHostname=n2 NodeAddr=127.0.0.1 Port=$(($2 + 3)) CPUs=1 RealMemory=2000
PartitionName=main Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
CONF
  export SLURM_CONF="$slurm/slurm.conf"
  wait_until 20 "munged's socket" test -S "$slurm/munge/socket"
  start_slurmctld
  start_slurmd n1
  start_slurmd n2
  wait_until 60 "both nodes are idle" nodes_idle
}
