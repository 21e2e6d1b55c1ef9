#!/bin/sh
# sample.sh FOLDER: mutate.py draws so many of each room by its seed, and lists who survives, of ten
# made-up mutants in each of two rooms, of which a made-up test finds those of even numbers.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
rm -rf "$1"
mkdir -p "$1/build"
python3 - >"$1/mutants.json" <<'PY'
import json
print(json.dumps([{"file": f"edge/{room}/x.h", "function": "f", "was": str(i), "is": "-", "nth": 1,
                   "number": 1000 * at + i}
                  for at, room in enumerate(["control", "loop"]) for i in range(10)]))
PY
cat >"$1/build/edge_test" <<'SH'
#!/bin/sh
case "$*" in *list_tests*) printf 'Suite.\n  Name\n'; exit 0 ;; esac
[ -z "${BESS_MUTANTS_PASSED:-}" ] || seq 0 1009 >"$BESS_MUTANTS_PASSED"
[ $((${BESS_MUTANT:-1} % 2)) = 1 ]
SH
chmod +x "$1/build/edge_test"
run() { python3 -B "$here/mutate.py" run --kinds edge_test --survivors "$1/left" --out "$@"; }
fail() { echo "$*"; exit 1; }
run "$1" --each 4 --seed 3 >"$1/said"
grep -q '^| edge/control | 4 |' "$1/said" && grep -q '^| edge/loop | 4 |' "$1/said" ||
  fail "not four of each room: $(cat "$1/said")"
cp "$1/results.jsonl" "$1/first"
run "$1" --each 4 --seed 3 >/dev/null
cmp -s "$1/first" "$1/results.jsonl" || fail "the same seed draws others"
run "$1" --each 4 --seed 4 >/dev/null
! cmp -s "$1/first" "$1/results.jsonl" || fail "another seed draws the same"
run "$1" --rooms loop >"$1/said"
grep -q '^| all | 10 | 0 | 5 | 0 | 5 | 50.0 % |' "$1/said" || fail "$(cat "$1/said")"
[ "$(grep -c '^survived:    edge/loop/x.h | f | [13579] -> -$' "$1/left")" = 5 ] ||
  fail "the survivors: $(cat "$1/left")"
! run "$1" --rooms loop --at-least 51 >/dev/null 2>&1 || fail "half is taken for 51 %"
! run "$1" --rooms lop >/dev/null 2>"$1/said" || fail "a room that is none is taken"
grep -q '"lop" is none of control' "$1/said" || fail "$(cat "$1/said")"
