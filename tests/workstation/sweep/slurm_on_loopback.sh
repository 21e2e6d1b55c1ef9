#!/bin/sh
# slurm_on_loopback.sh PROGRAM FOLDER
#   The same plan of six real tasks here and on a real Slurm of two nodes on this machine: every
#   file that is published is the same, byte for byte; called again while it runs, and once it is
#   done, nothing is sent twice. Needs slurm-wlm and munge, as root; without them it is skipped.
set -eu
program=$1
folder=$2
. "$(dirname "$0")/loopback_slurm.sh"

rm -rf "$folder"
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
start_slurm "$folder" 17816

cd "$folder"
printf '[train]\nsteps = 20\n[distil]\nepochs = 60\n' >few.toml
"$program" prices simulate --days 60 --out market.csv.gz >/dev/null
for out in here there; do
  "$program" sweep plan --prices market.csv.gz --config few.toml --set distil.fidelity=1,2 \
    --seeds 3 --out $out
done
"$program" sweep run there --slurm --chunk 1 -- --partition=main
"$program" sweep run there --slurm >again.txt
grep -q 'nothing to send: 0 of 6 done, 6 wait or run' again.txt || { cat again.txt; exit 1; }
"$program" sweep status there

# One that is cancelled is missing, did not fail, and is sent again.
two_run() { [ "$(squeue --noheader --states=running --format=%i | wc -l)" -ge 2 ]; }
wait_until 20 "two elements run" two_run
scancel "$(squeue --noheader --states=running --format=%i | head -1)"
wait_until 600 "the queue is empty" queue_is_empty
"$program" sweep status there
[ ! -e there/failures ] || { grep -r . there/failures; exit 1; }
"$program" sweep run there --slurm -- --partition=main | tee sent.txt
grep -q '1 task in 1 element of 1 each (about .* s a task), 5 done' sent.txt
wait_until 600 "the queue is empty" queue_is_empty
"$program" sweep run there --slurm >again.txt
grep -q 'nothing to send: 6 of 6 done' again.txt || { cat again.txt; cat there/log/*; exit 1; }

"$program" sweep run here --jobs 2
for task in 1 2 3 4 5 6; do
  diff -r --exclude=times.json "here/tasks/000/00000$task" "there/tasks/000/00000$task"
done
"$program" sweep collect there
echo "six tasks here and on Slurm: the same, byte for byte"
