#!/bin/bash
# year.sh BESS-HIL: a year in virtual time, twice: judged, and bit-identical; then once behind a
# house's meter with limits of power and of quarter-hours. Prints the processor time of each.
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
cat "$work/year.toml" - >"$work/year_of_a_house.toml" <<END

[house]
seed = 7

[meter]
map = "simulator"

[edge]
meter = """
import_w_max = 9000
peak_w_max = 6000
"""
END
export TIMEFORMAT='%U s of processor, %S s of the kernel'
year() {  # year BESS-HIL SCENARIO
  time "$1" run "$work/$2.toml" --json >"$work/said" || { cat "$work/said"; exit 1; }
  sed -n 's/.*"signature": *"\([0-9a-f]*\)".*/\1/p' "$work/said"
}
first=$(year "$1" year) || { echo "$first"; exit 1; }
second=$(year "$1" year) || { echo "$second"; exit 1; }
house=$(year "$1" year_of_a_house) || { echo "$house"; exit 1; }
echo "signatures $first $second, behind a house's meter $house"
[ -n "$first" ] && [ "$first" = "$second" ]
