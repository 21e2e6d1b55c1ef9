#!/bin/sh
# slurm_on_loopback.sh PROGRAM FOLDER
#   The same plan of six real tasks here and on a real Slurm of two nodes on this machine: every
#   file that is published is the same, byte for byte; called again while it runs, and once it is
#   done, nothing is sent twice. Needs slurm-wlm and munge, as root; without them it is skipped.
set -eu
program=$1
folder=$2
PATH=$PATH:/usr/sbin

if [ "$(id -u)" != 0 ]; then echo "SKIPPED: Slurm on loopback needs root"; exit 77; fi
for tool in slurmctld slurmd munged sbatch unshare; do
  if ! command -v $tool >/dev/null; then
    echo "SKIPPED: no $tool here; tools/setup --test installs slurm-wlm and munge"
    exit 77
  fi
done

rm -rf "$folder"
mkdir -p "$folder/munge" "$folder/state" "$folder/spool-n1" "$folder/spool-n2"
folder=$(cd "$folder" && pwd)
chmod 755 "$folder" "$folder/munge"
key=$folder/munge/key socket=$folder/munge/socket
dd if=/dev/urandom of="$key" bs=1024 count=1 2>/dev/null
chmod 400 "$key"

# Every program that is started here ends with this script, by its own number.
pids=
stop() {
  for pid in $pids; do kill "$pid" 2>/dev/null || true; done
  for pid in $pids; do wait "$pid" 2>/dev/null || true; done
}
trap stop EXIT
trap 'exit 1' INT TERM

munged --foreground --force --key-file="$key" --socket="$socket" --pid-file="$folder/munge/pid" \
  --log-file="$folder/munge/log" --seed-file="$folder/munge/seed" >"$folder/munged.txt" 2>&1 &
pids="$pids $!"

# The least that Slurm needs: no accounting, no cgroups, two nodes by their ports.
cat >"$folder/slurm.conf" <<CONF
ClusterName=loopback
SlurmctldHost=localhost(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket=$socket
SlurmUser=root
SlurmdUser=root
SlurmctldPort=17816
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd-%n.pid
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool-%n
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd-%n.log
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
NodeName=n1 NodeHostname=n1 NodeAddr=127.0.0.1 Port=17818 CPUs=1 RealMemory=2000
NodeName=n2 NodeHostname=n2 NodeAddr=127.0.0.1 Port=17819 CPUs=1 RealMemory=2000
PartitionName=main Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF="$folder/slurm.conf"
tries=0
until [ -S "$socket" ]; do
  tries=$((tries + 1))
  [ $tries -lt 100 ] || { echo "munged does not come up:"; cat "$folder/munged.txt"; exit 1; }
  sleep 0.2
done
slurmctld -D -f "$SLURM_CONF" >"$folder/slurmctld.txt" 2>&1 &
pids="$pids $!"
for node in n1 n2; do
  unshare --uts sh -c "hostname $node; exec slurmd -D -N $node -f '$SLURM_CONF'" \
    >"$folder/$node.txt" 2>&1 &
  pids="$pids $!"
done
tries=0
until [ "$(sinfo --noheader --format=%D --states=idle 2>/dev/null)" = 2 ]; do
  tries=$((tries + 1))
  [ $tries -lt 150 ] || { echo "the nodes do not come up:"; tail -5 "$folder"/*.log; exit 1; }
  sleep 0.4
done

cd "$folder"
printf '[train]\nsteps = 20\n[distil]\nepochs = 60\n' >few.toml
"$program" prices simulate --days 60 --out market.csv.gz >/dev/null
for out in here there; do
  "$program" sweep plan --prices market.csv.gz --config few.toml --set distil.fidelity=1,2 \
    --seeds 3 --out $out
done
"$program" sweep run there --slurm -- --partition=main
"$program" sweep run there --slurm >again.txt
grep -q 'nothing to send: 0 of 6 done, 6 wait or run' again.txt || { cat again.txt; exit 1; }
"$program" sweep status there

# One that is cancelled and one whose program is killed are missing, and sent again.
tries=0
until [ "$(squeue --noheader --states=running --format=%i | wc -l)" -ge 2 ]; do
  tries=$((tries + 1))
  [ $tries -lt 100 ] || { echo "nothing runs"; squeue; exit 1; }
  sleep 0.2
done
scancel "$(squeue --noheader --states=running --format=%i | head -1)"

wait_for_queue() {
  tries=0
  while [ -n "$(squeue --noheader)" ]; do
    tries=$((tries + 1))
    [ $tries -lt 600 ] || { echo "the queue does not empty"; squeue; exit 1; }
    sleep 1
  done
}
wait_for_queue
"$program" sweep status there
"$program" sweep run there --slurm -- --partition=main
wait_for_queue
"$program" sweep run there --slurm >again.txt
grep -q 'nothing to send: 6 of 6 done' again.txt || { cat again.txt; cat there/log/*; exit 1; }

"$program" sweep run here --jobs 2
for task in 1 2 3 4 5 6; do
  diff -r --exclude=times.json "here/tasks/000/00000$task" "there/tasks/000/00000$task"
done
"$program" sweep collect there
echo "six tasks here and on Slurm: the same, byte for byte"
