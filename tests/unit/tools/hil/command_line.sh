#!/bin/sh
# command_line.sh PROGRAM SCENARIOS: output and exit codes of bess-hil, for people and for machines.
program=$1
scenarios=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
complain() { echo "$*"; exit 1; }

"$program" run --help | grep -q 'bess-hil run tests/scenarios --time both' ||
  complain "no example in --help"
"$program" run "$scenarios" --list | grep -q '^quiet_hour .*An hour in which nothing goes wrong' ||
  complain "--list"
"$program" run "$scenarios" --list --json |
  grep -q '"scenario": *"quiet_hour",.*"time": *"both","real"' || complain "--list --json"
"$program" run "$scenarios/quiet_hour.toml" "$scenarios/disk_full.toml" --json >"$work/skip.json" ||
  complain "a skipped run fails"
grep -q '"disk_full","time": *"virtual","passed": *false,"verdict": *"skipped"' "$work/skip.json" ||
  complain "skipped is passed: $(cat "$work/skip.json")"
"$program" run "$scenarios/quiet_hour.toml" --json --junit "$work/a.xml" >"$work/a.json" ||
  complain "quiet_hour failed"
grep -q '"passed": *1' "$work/a.json" || complain "--json: $(cat "$work/a.json")"
grep -q '<testcase classname="virtual" name="quiet_hour"' "$work/a.xml" ||
  complain "--junit: $(cat "$work/a.xml")"

# A map next to its scenario, from the folder of both.
cp "$scenarios/../../edge/device/maps/kostal_plenticore.toml" "$work/mine.toml"
printf 'title = "mine"\nminutes = 60\n[battery]\nmap = "mine.toml"\n' >"$work/mine_hour.toml"
(cd "$work" && "$program" run mine_hour.toml >mine.txt 2>&1) || complain "$(cat "$work/mine.txt")"

# A repeated run is bit-identical.
signature() { sed 's/.*"signature": *"\([0-9a-f]*\)".*/\1/'; }
first=$(signature <"$work/a.json")
second=$("$program" run "$scenarios/quiet_hour.toml" --json | signature)
[ "$first" = "$second" ] || complain "two runs differ: $first $second"

# A failing scenario reports expectation, observation and time in one line; exit code 1.
{ cat "$scenarios/quiet_hour.toml"; printf '\n[[expect]]\nfrom_min = 10\ncommand = "none"\n'; } \
  >"$work/wrong.toml"
"$program" run "$work/wrong.toml" --junit "$work/b.xml" >"$work/wrong.txt" 2>"$work/wrong.err" &&
  complain "wrong.toml passed"
told='expect 1: .* W, .*2023-03-26T00:10:25Z .*10.4'
grep -q "^FAIL .*$told" "$work/wrong.txt" ||
  complain "$(cat "$work/wrong.txt")"
grep -q '<failure message="expect 1: ' "$work/b.xml" ||
  complain "$(cat "$work/b.xml")"

# A page with charts: their data, faults and events by name, links, findings; a minus is no hyphen.
"$program" run "$work/wrong.toml" "$scenarios/bus_silence.toml" "$scenarios/edge_killed.toml" \
  "$scenarios/disk_full.toml" --report "$work/page.html" >/dev/null 2>&1
for text in '"kind":"battery","name":"battery: silence"' \
  'silence","from_utc_s":1679790000,"to_utc_s":1679791200' \
  '"kind":"event","name":"edge_kill"' '"price_eur_per_mwh":\[\[1679788' '"ordered_w":\[\[' \
  '"measured_w":\[\[' '"soc_percent":\[\[' '"mode":\[\[[0-9]*,"[a-z]*"\]' 'width=device-width' \
  'prefers-color-scheme: dark' '<canvas id="chart-virtual-wrong" role="img">' \
  '<th scope="col">' '<th scope="row">expect 1' '<td [^>]*>−[0-9]* W' \
  '<a href="#virtual-wrong">.*<span class="failed">' '<section id="virtual-wrong">' \
  '<span class="skipped">'; do
  grep -q -e "$text" "$work/page.html" || complain "no \"$text\" on the page"
done
grep -m 1 '<td [^>]*>-[0-9]' "$work/page.html" && complain "a hyphen for a minus"

# An unreadable file: one line with file, line and correction; a wrong option: 2.
printf 'title = "x"\nminuts = 3\n' >"$work/bad.toml"
"$program" run "$work/bad.toml" >/dev/null 2>"$work/bad.err" && complain "bad.toml was accepted"
grep -q 'bad.toml:2: .*minuts' "$work/bad.err" || complain "$(cat "$work/bad.err")"
[ "$(wc -l <"$work/bad.err")" -eq 1 ] || complain "more than one line: $(cat "$work/bad.err")"
printf 'title = "x"\n[edge]\nguard = "soc_minn = 0.2"\n' >"$work/edge.toml"
"$program" run "$work/edge.toml" 2>/dev/null |
  grep -q 'edge.toml: \[edge\].*\[guard\] soc_minn' || complain "[edge]'s mistake"
TMPDIR=/nowhere "$program" run "$scenarios/quiet_hour.toml" 2>&1 | grep -q TMPDIR ||
  complain "no TMPDIR"

# Ctrl-C: exit code 3, and no files remain.
mkdir "$work/tmp"
TMPDIR=$work/tmp "$program" run "$scenarios/a_week_of_2023.toml" "$scenarios" >/dev/null \
  2>"$work/stop.err" & run=$!
while [ -z "$(ls "$work/tmp")" ] && kill -0 $run; do sleep 0.01; done
kill -INT $run
wait $run
[ $? -eq 3 ] || complain "interrupted: not exit code 3: $(cat "$work/stop.err")"
[ -z "$(ls "$work/tmp")" ] || complain "left behind: $(ls "$work/tmp")"

"$program" run --tim both 2>/dev/null
[ $? -eq 2 ] || complain "a wrong option is not exit code 2"
exit 0
