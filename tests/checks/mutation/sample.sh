#!/bin/sh
# sample.sh FOLDER: mutate.py draws mutants of each room by its seed, lists survivors and compares
# two trees, on ten invented mutants in two rooms, of which a test finds the even ones.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
rm -rf "$1"
mkdir -p "$1/build"
python3 - >"$1/mutants.json" <<'PY'
import json
print(json.dumps([{"file": f"edge/{room}/x.h", "function": "f", "was": str(i), "is": "-", "nth": 1,
                   "number": 1000 * at + i}
                  for at, room in enumerate(["core/control", "core/loop"]) for i in range(10)]))
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
grep -q '^| core/control | 4 |' "$1/said" && grep -q '^| core/loop | 4 |' "$1/said" ||
  fail "not four of each room: $(cat "$1/said")"
cp "$1/results.jsonl" "$1/first"
run "$1" --each 4 --seed 3 >/dev/null
cmp -s "$1/first" "$1/results.jsonl" || fail "the same seed draws others"
run "$1" --each 4 --seed 4 >/dev/null
! cmp -s "$1/first" "$1/results.jsonl" || fail "another seed draws the same"
run "$1" --rooms core/loop >"$1/said"
grep -q '^| all | 10 | 0 | 5 | 0 | 5 | 50.0 % |' "$1/said" || fail "$(cat "$1/said")"
[ "$(grep -c '^survived:    edge/core/loop/x.h | f | [13579] -> -$' "$1/left")" = 5 ] ||
  fail "the survivors: $(cat "$1/left")"
! run "$1" --rooms core/loop --at-least 51 >/dev/null 2>&1 || fail "half passes as 51 %"
! run "$1" --rooms core/lop >/dev/null 2>"$1/said" || fail "an unknown room is accepted"
grep -q '"core/lop" is none of core/control' "$1/said" || fail "$(cat "$1/said")"

# Another tree, which only has core/loop and whose test finds the odd numbers: the mutants drawn are
# in both trees, and those that only its test finds are reported as lost.
rm -rf "$1-there"
mkdir -p "$1-there/build"
python3 - "$1/mutants.json" >"$1-there/mutants.json" <<'PY'
import json, sys
print(json.dumps([m for m in json.load(open(sys.argv[1])) if "loop" in m["file"]]))
PY
sed 's/MUTANT:-1/MUTANT:-0/; s/= 1 /= 0 /' "$1/build/edge_test" >"$1-there/build/edge_test"
chmod +x "$1-there/build/edge_test"
python3 -B "$here/mutate.py" draw --out "$1" --also-in "$1-there" --sample 6 --seed 5 >"$1/keys"
[ "$(grep -c '^edge/core/loop/x.h | f | . -> -$' "$1/keys")" = 6 ] || fail "drawn: $(cat "$1/keys")"
run "$1" --keys "$1/keys" >/dev/null
run "$1-there" --keys "$1/keys" >/dev/null
! python3 -B "$here/mutate.py" compare --out "$1" --than "$1-there" >"$1/said" ||
  fail "the lost mutants: $(cat "$1/said")"
odd=$(grep -c '[13579] -> -$' "$1/keys")
grep -q "^| core/loop | 6 | 0 | 0 | $odd | $((6 - odd)) | 0 |" "$1/said" ||
  fail "$(cat "$1/said")"
[ "$(grep -c '^lost: .*, found there by edge_test Suite.Name$' "$1/said")" = "$odd" ] ||
  fail "$(cat "$1/said")"
python3 -B "$here/mutate.py" compare --out "$1" --than "$1" >/dev/null || fail "lost to itself"
echo 'edge/core/loop/x.h | f | none -> -' >>"$1/keys"
! run "$1" --keys "$1/keys" >/dev/null 2>"$1/said" || fail "an unknown key is accepted"
grep -q 'keys: this tree has no "edge/core/loop/x.h | f | none -> -"' "$1/said" ||
  fail "$(cat "$1/said")"
