#!/bin/sh
# same_bytes.sh PROGRAM FOLDER
#   The same plan of six real tasks by GNU parallel and on a real Slurm of two local nodes, both
#   killed and resumed on the way: every file that a task leaves and every table is the same, byte
#   for byte. Needs parallel, and as root slurm-wlm and munge; without them it is skipped.
set -eu
program=$1
folder=$2
. "$(dirname "$0")/loopback_slurm.sh"
for tool in parallel pgrep; do
  command -v $tool >/dev/null || skip "no $tool here; tools/setup --test installs it"
done

rm -rf "$folder"
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
start_slurm "$folder" 17816
cd "$folder"

# Processes of tasks, by their sweep.
pids_of() { pgrep -f "^$program sweep task $folder/$1 [0-9]"; }
one_runs() { [ "$(pids_of "$1" | wc -l)" -ge 1 ]; }
two_run() { [ "$(pids_of "$1" | wc -l)" -ge 2 ]; }
kill_one() { kill -9 "$(pids_of "$1" | head -n 1)"; }
collect() { "$program" sweep collect "$1" "$2" | tee "collected_$1.txt"; }

printf '[train]\nsteps = 20\n[distil]\nepochs = 60\n' >few.toml
"$program" prices simulate --days 60 --out market.csv.gz >/dev/null
for out in here there; do
  "$program" sweep plan --prices market.csv.gz --config few.toml --set distil.fidelity=1,2 \
    --seeds 3 --out $out | tee planned_$out.txt
done
grep -q '^parallel .*--resume-failed' planned_here.txt

echo "== here: a task is killed, then GNU parallel, whose tasks live on beside those of the next"
setsid "$program" sweep run here --jobs 2 &
engine=$!
echo $engine >"$slurm/parallel.started"
wait_until 60 "two tasks run" two_run here
kill_one here
killed() { grep -q '	137	' here/joblog; }
wait_until 60 "parallel knows of it" killed
wait_until 60 "two tasks run again" two_run here
kill_hard parallel
wait $engine || true
! "$program" sweep collect here >early.txt 2>&1 || { cat early.txt; exit 1; }
grep -q -- '--partial' early.txt
"$program" sweep run here --jobs 2
collect here --partial
grep -q '6 tasks, 6 proved' collected_here.txt

echo "== there: sent twice; a task, slurmctld and a slurmd are killed, one element cancelled"
sent() { eval "$(grep '^sbatch' "$1")"; }
busy() { [ -n "$(squeue --noheader --states=running --nodelist="$1")" ] && one_runs there; }
day() {
  wait_until 120 "$1: two tasks run" two_run there
  echo "-- $1"
}
sent planned_there.txt
sent planned_there.txt
day "a task is killed"
kill_one there
day "an element is cancelled"
scancel "$(squeue --noheader --states=running --format=%i | head -n 1)"
day "slurmctld is killed"
sleep 3
kill_hard slurmctld
sleep 2
start_slurmctld
wait_until 60 "slurmctld answers" scontrol ping
sent planned_there.txt
wait_until 120 "n2 is busy" busy n2
echo "-- a slurmd is killed"
kill_hard n2
sleep 2
start_slurmd n2
wait_until 120 "n1 is busy" busy n1
sleep 3
echo "-- a node is down: what it ran is requeued, and begins two minutes later"
scontrol update nodename=n1 state=down reason=test
sleep 1
scontrol update nodename=n1 state=resume || true  # or it recovered by itself
squeue
# Administration of Slurm: requeues tasks that could not start, and drains a node that knows more
# than a slurmctld with lost state.
look_after() {
  squeue --noheader --array --states=pending --format='%i %r' | while read -r job reason; do
    case $reason in *held*) scontrol release "$job" || true ;; esac
  done
  sinfo --noheader --Node --format='%N %E' | while read -r node reason; do
    case $reason in Duplicate*) scontrol update nodename="$node" state=resume || true ;; esac
  done
  queue_is_empty
}
wait_until 900 "the queue is empty" look_after

echo "== there: half of an output, and an output that may not be written; then what is missing"
rm -f there/tasks/000/000002/run.json
printf 'half' >there/tasks/000/000002/student.json
mkdir -p there/tasks/000
mount --bind there/tasks/000 there/tasks/000
mount -o remount,ro,bind there/tasks/000
! "$program" sweep task there 2 || exit 1
umount there/tasks/000
collect there --partial
grep -q 'task 2 failed: .*ead-only' collected_there.txt
for round in 1 2 3; do
  grep -q '^sbatch' collected_there.txt || break
  sent collected_there.txt
  wait_until 400 "the queue is empty" look_after
  collect there --partial
done
grep -q '6 tasks, 6 proved' collected_there.txt

diff -r --exclude=times.json here/tasks there/tasks
cmp here/settings.csv there/settings.csv
for out in here there; do
  sed 's/,[^,]*$//' $out/tasks.csv >$out.csv  # without the duration of each
done
cmp here.csv there.csv
[ -z "$(find here/log there/log -name '0*')" ] || { ls here/log there/log; exit 1; }
echo "six tasks by GNU parallel and on Slurm, killed and resumed: the same, byte for byte"
