#!/bin/bash
# year.sh BESS-HIL: a year in virtual time, twice: judged, and the same to the bit. Tells the
# processor time of each.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/year.toml" <<END
title = "A year"
minutes = 525600
time = "virtual"
start_utc = "2023-01-01T00:00:00Z"

[prices]                              # a day's wave, which moves through the hours of the year
wave = { mean = 100, amplitude = 400, period_min = 1441 }
END
export TIMEFORMAT='%U s of processor, %S s of the kernel'
year() {
  time "$1" run "$work/year.toml" --json >"$work/said" || { cat "$work/said"; exit 1; }
  sed -n 's/.*"signature": *"\([0-9a-f]*\)".*/\1/p' "$work/said"
}
first=$(year "$1") || { echo "$first"; exit 1; }
second=$(year "$1") || { echo "$second"; exit 1; }
echo "signatures $first $second"
[ -n "$first" ] && [ "$first" = "$second" ]
