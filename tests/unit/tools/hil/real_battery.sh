#!/bin/bash
# real_battery.sh BESS-HIL BESS-SIM [serial]: --real against a simulated battery as an external
# device: refused unless all options are given, driven within its limits, released on every exit.
hil=$1 sim=$2
work=$(mktemp -d)
children=()
clean_up() { [ ${#children[@]} -eq 0 ] || kill "${children[@]}" 2>/dev/null; wait; rm -rf "$work"; }
trap clean_up EXIT
complain() { echo "$*"; cat "$work"/*.txt; exit 1; }
export TMPDIR=$work/tmp
mkdir "$TMPDIR"

scale=120
start=(--time-scale $scale --utc-start 2023-03-26T00:00:00Z --soc 0.5 --events "$work/events.csv")
if [ "${3:-}" = serial ]; then
  command -v socat >/dev/null || { echo "skipped: socat is not installed"; exit 77; }
  socat pty,raw,echo=0,link="$work/a" pty,raw,echo=0,link="$work/b" & children+=($!)
  for _ in {1..100}; do [ -e "$work/b" ] && break; sleep 0.05; done
  address=$work/b
  start+=(--serial "$work/a" --baud 115200)
  line=(--real-baud 115200)
else
  start+=(--port 0)
  line=()
fi
"$sim" battery "${start[@]}" >"$work/sim.txt" & battery=$!
children+=($battery)
for _ in {1..100}; do grep -q listening "$work/sim.txt" && break; sleep 0.05; done
[ -n "${address:-}" ] || address=$(grep -o '127.0.0.1:[0-9]*' "$work/sim.txt")

cat >"$work/short.toml" <<END
title = "Charged, then discharged"
minutes = 12

[prices]
steps = [[0, -300], [5, 900]]

[[expect]]
from_min = 6
to_min = 10
command = "discharge"
END
cat >"$work/long.toml" <<END
title = "Until somebody ends it"
minutes = 180

[prices]
steps = [[0, -300]]
END
limits=(--real-map alphaess --real-capacity-wh 8000 --real-power-w 500 --real-soc-min 0.3
  --real-soc-max 0.7
        --real-time-scale $scale)
real=(--real "$address" "${line[@]}" --yes-drive-real-battery "${limits[@]}")

# No option is guessed.
refused() {  # refused TEXT CODE OPTIONS...: one line that holds TEXT
  local text=$1 code=$2
  shift 2
  "$hil" run "$@" >"$work/out.txt" 2>"$work/err.txt"
  [ $? -eq "$code" ] || complain "not exit code $code: $*"
  [ "$(wc -l <"$work/err.txt")" -eq 1 ] && grep -q -e "$text" "$work/err.txt" ||
    complain "not \"$text\": $*"
}
refused "--yes-drive-real-battery" 2 "$work/short.toml" --real "$address" "${limits[@]}"
refused "--real-power-w" 2 "$work/short.toml" --real "$address" \
  --yes-drive-real-battery --real-map alphaess \
  --real-capacity-wh 8000 --real-soc-min 0.3 --real-soc-max 0.7
refused "--real-soc-min" 1 "$work/short.toml" "${real[@]/0.7/0.2}"
printf 'title = "x"\n[battery_fault]\nkinds = ["silence"]\n' >"$work/fault.toml"
refused "fault.toml: .*silence" 1 \
  "$work/fault.toml" "${real[@]}"

# It runs, judged, within its limits.
"$hil" run "$work/short.toml" "${real[@]}" >"$work/run.txt" 2>&1 || complain "it failed"
grep -q '^ok    real    short' "$work/run.txt" || complain "no verdict"
grep -q 'mode=stopping battery=ok' "$work/run.txt" || complain "its release is not reported"

# await TEXT: until the edge of the current run has logged it.
await() {
  for _ in {1..1200}; do
    grep -qs -e "$1" "$TMPDIR"/bess-hil-*/edge-*.log && return; sleep 0.05
  done
  complain "the edge never logged \"$1\""
}
ends_released() {  # ends_released CODE TEXT: the cause and the kind of end
  [ "$1" -eq 3 ] || complain "$2: exit code $1"
  grep -q 'mode=stopping battery=ok' "$work/run.txt" ||
    complain "$2: its release is not reported"
}
# A signal ends it immediately; so does the key, at a terminal.
"$hil" run "$work/long.toml" "${real[@]}" >"$work/run.txt" 2>&1 & run=$!
await 'mode=running'
kill -INT $run
wait $run
ends_released $? "Ctrl-C"
(await 'mode=running' >&2; printf q) | setsid script -qec "$hil run $work/long.toml ${real[*]}" \
  /dev/null >"$work/run.txt" 2>&1
ends_released $? "the key"
# When killed, it ends the edge too, which releases the battery.
"$hil" run "$work/long.toml" "${real[@]}" >"$work/run.txt" 2>&1 & run=$!
await 'mode=running'
kill -KILL $run
wait $run 2>/dev/null
await 'mode=stopping'
kill -TERM $battery
wait $battery

# By the battery's own record: its orders, and that each run released it.
awk -F, 'NR > 1 && ($3 > 500 || $3 < -500) { exit 1 }' "$work/events.csv" ||
  complain "beyond 500 W: $(cat "$work/events.csv")"
grep -q ',order,500,' "$work/events.csv" && grep -q ',order,-500,' "$work/events.csv" ||
  complain "never driven"
[ "$(tail -n 1 "$work/events.csv" | cut -d, -f2)" = stop ] ||
  complain "not released: $(tail -n 3 "$work/events.csv")"
# A run that passed, or was ended, leaves no files; a killed one does.
[ "$(ls "$TMPDIR" | wc -l)" -eq 1 ] || complain "left behind: $(ls "$TMPDIR")"
exit 0
