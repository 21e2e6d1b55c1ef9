#!/bin/sh
# slurm_bad_days.sh WORKER FOLDER
#   What a cluster does on bad days, one after the other, on a real Slurm of two nodes on this
#   machine, each to a sweep of 24 tasks that cost a third of a second: after each of them nothing
#   is lost, half, doubled or different, and a second submission sends nothing. Only what a task
#   itself did is one of its three failures. Last, 10,000 tasks that cost nothing, for the rate.
#   Needs slurm-wlm, munge and faketime, as root; without them it is skipped.
set -eu
worker=$1
folder=$2
. "$(dirname "$0")/loopback_slurm.sh"
command -v faketime >/dev/null || skip "no faketime here; tools/setup --test installs it"

tmpfs=$folder/tmpfs
umount "$tmpfs" 2>/dev/null || true
rm -rf "$folder"
mkdir -p "$tmpfs"
folder=$(cd "$folder" && pwd)
tmpfs=$folder/tmpfs
start_slurm "$folder" 17826
cd "$folder"
export BESS_WORKER_MS=100
tasks=24

complain() {
  echo "$day: $1"
  "$worker" check "$sweep" $tasks || true
  grep -r . "$sweep/failures" "$sweep/log" | tail -n 20
  exit 1
}
# begin DAY [OPTION...]: sent in four elements of six; what is sent already is not sent again.
begin() {
  day=$1 sweep=${at:-$folder}/$1
  shift
  "$worker" send "$sweep" $tasks 10 "$@" | tee sent.txt
  grep -q 'sent 24 in 4 of 6' sent.txt || complain "was not sent"
  sends_nothing
}
sends_nothing() {
  "$worker" send "$sweep" $tasks 10 >sent.txt
  grep -q 'sent 0' sent.txt || { cat sent.txt; complain "was sent twice"; }
}
is_at_work() { [ -n "$(find "$sweep/attempts" -mindepth 2 -maxdepth 2 ! -name '*.ended')" ]; }
# What whoever looks after Slurm does: what it could not start, as it was cancelled just then, it
# holds; a node that knew more than a slurmctld that forgot is drained. What it takes back begins
# two minutes later.
look_after() {
  squeue --noheader --array --states=pending --format='%i %r' | while read -r job reason; do
    case $reason in *held*) scontrol release "$job" || true ;; esac
  done
  sinfo --noheader --Node --format='%N %E' | while read -r node reason; do
    case $reason in Duplicate*) scontrol update nodename="$node" state=resume || true ;; esac
  done
  queue_is_empty
}
settle() { wait_until 400 "$day: the queue is empty" look_after; }
# end FAILURES DIFFERENT: what is missing is sent until it is there.
end() {
  settle
  for round in 1 2 3; do
    "$worker" check "$sweep" $tasks >came.txt || complain "is not whole"
    ! grep -q '^24 done' came.txt || break
    "$worker" send "$sweep" $tasks 10
    settle
  done
  "$worker" check "$sweep" $tasks >came.txt || complain "is not whole"
  grep -q "^24 done, 0 missing, 0 failed, $1 failures, $2 different" came.txt ||
    complain "expected all 24, $1 failures and $2 different"
  sends_nothing
  [ "$(find "$sweep/tasks" -type f | wc -l)" = 72 ] || complain "other files than three a task"
  echo "ok: $day: $(cat came.txt)"
}
# pid_at_work: of a task's process, which is the third field from the end of its attempt's name.
pid_at_work() {
  find "$sweep/attempts" -mindepth 2 -maxdepth 2 ! -name '*.ended' | head -n 1 |
    sed 's/.*\.\([0-9]*\)\.[0-9]*$/\1/'
}

begin a_task_killed
wait_until 30 "$day: a task is at work" is_at_work
kill -9 "$(pid_at_work)"
end 1 0

day=two_submitters sweep=$folder/two_submitters
"$worker" send "$sweep" $tasks 10 &
first=$!
"$worker" send "$sweep" $tasks 10
wait $first
end 0 0

begin slurmd_killed
wait_until 30 "$day: a task is at work" is_at_work
kill_hard n1
sleep 2
start_slurmd n1
end 0 0

begin slurmctld_killed
sleep 3
kill_hard slurmctld
sleep 2
start_slurmctld
wait_until 60 "$day: slurmctld answers" scontrol ping
end 0 0

begin all_cancelled
wait_until 30 "$day: a task is at work" is_at_work
scancel --user=root
end 0 0

begin one_element_cancelled
wait_until 30 "$day: a task is at work" is_at_work
scancel "$(squeue --noheader --states=running --format=%i | head -n 1)"
end 0 0

begin a_node_drained
wait_until 30 "$day: a task is at work" is_at_work
scontrol update nodename=n1 state=drain reason=test
end 0 0
scontrol update nodename=n1 state=resume
wait_until 30 "both nodes are idle" nodes_idle

begin a_node_down
wait_until 30 "$day: a task is at work" is_at_work
scontrol update nodename=n1 state=down reason=test
end 0 0
scontrol update nodename=n1 state=resume || true  # or it came back by itself
wait_until 60 "both nodes are idle" nodes_idle

# The tasks' clock: an hour ahead, then an hour behind; and as if it had been so for the files.
echo +1h >clock
preload=$(dpkg -L libfaketime | grep '/libfaketime.so.1$')
fake="LD_PRELOAD=$preload,FAKETIME_TIMESTAMP_FILE=$folder/clock,FAKETIME_NO_CACHE=1"
begin a_clock_that_steps "--export=ALL,$fake,FAKETIME_DONT_FAKE_MONOTONIC=1"
wait_until 30 "$day: a task is at work" is_at_work
echo -1h >clock
find "$sweep" -exec touch --no-create -d '+1 hour' {} + || true
end 0 0

# What another machine left half, what a copy by hand left half, and where nobody may publish.
day=half_and_read_only sweep=$folder/half_and_read_only
half=$sweep/attempts/000002/elsewhere.00000000.1.1
mkdir -p "$half" "$sweep/tasks/000/000003" "$folder/there"
printf 'student.js' >"$half/student.json"
printf 'student.js' >"$sweep/tasks/000/000003/student.json"
mount --bind "$sweep/tasks/000" "$sweep/tasks/000"
mount -o remount,ro,bind "$sweep/tasks/000"
"$worker" send "$sweep" $tasks 10
settle
umount "$sweep/tasks/000"
"$worker" check "$sweep" $tasks | grep -q '^0 done, 24 missing, 0 failed, 0 failures' ||
  complain "published where nobody may"
end 0 1

# With no room, or no room for names: what is there is whole, and the rest follows once there is.
for limit in size=160k nr_inodes=90; do
  mount -t tmpfs -o $limit bess-bad-day "$tmpfs"
  day=full_$limit sweep=$tmpfs/full
  mkdir -p "$sweep"
  "$worker" send "$sweep" $tasks 10
  settle
  "$worker" check "$sweep" $tasks | tee came.txt
  ! grep -q '^\(0\|24\) done' came.txt || complain "the disk was not full, or nothing was made"
  mount -o remount,size=10m,nr_inodes=10000 "$tmpfs"
  rm -rf "$sweep/failures"  # as 'sweep run --again'
  end 0 0
  umount "$tmpfs"
done

# An sbatch that took the job, and whose answer is lost: it fails, or never comes back.
mkdir -p lost
real=$(command -v sbatch)
path_before=$PATH
for answer in 'exit 1' 'sleep 600'; do
  printf '#!/bin/sh\n%s "$@" >/dev/null\n%s\n' "$real" "$answer" >lost/sbatch
  chmod +x lost/sbatch
  day="lost_${answer%% *}" sweep=$folder/lost_${answer%% *}
  PATH=$folder/lost:$path_before timeout 10 "$worker" send "$sweep" $tasks 10 ||
    echo "$day: gave up"
  sends_nothing
  end 0 0
done

export BESS_WORKER_MS=0
sweep=$folder/ten_thousand
start_s=$(date +%s)
"$worker" send "$sweep" 10000 0.01
while ! queue_is_empty; do sleep 1; done
"$worker" check "$sweep" 10000 | grep -q '^10000 done, 0 missing, 0 failed, 0 failures' ||
  complain "not all of 10,000"
seconds=$(($(date +%s) - start_s))
echo "10,000 tasks through Slurm in $seconds s: $((10000 / seconds)) a second"
