#!/bin/sh
# time_outs.sh CTEST BUILD FOLDER: fails, naming the test, if a test of BUILD has no time-out;
# checks also that it would notice. Runs in FOLDER, because ctest writes LastTest.log in its folder,
# even for a list, and that of BUILD belongs to the current run.
set -eu
mkdir -p "$3"
echo "subdirs(\"$2\")" >"$3/CTestTestfile.cmake"
list=$("$1" --test-dir "$3" --show-only=json-v1)
check() {  # a list of tests on stdin; one that is not built has no properties
  python3 -c '
import json, sys
tests = json.load(sys.stdin)["tests"]
lacking = [test["name"] for test in tests if not test["name"].endswith("_NOT_BUILT")
           and not any(p["name"] == "TIMEOUT" and p["value"] > 0
                       for p in test.get("properties", []))]
for name in lacking[:10]:
    print(name + " has no time-out: add it by a function of tests/CMakeLists.txt")
if lacking: print(f"{len(lacking)} of {len(tests)} tests have none")
sys.exit(1 if lacking or not tests else 0)'
}
printf '%s\n' "$list" | check
# The same list without the last of its time-outs.
without=$(printf '%s\n' "$list" | awk '/"TIMEOUT"/ { last = NR } { line[NR] = $0 }
  END {
    for (i = 1; i <= NR; ++i) { if (i == last) sub("TIMEOUT", "OTHER", line[i]); print line[i] }
  }')
! printf '%s\n' "$without" | check >/dev/null || {
  echo "a test without a time-out would not be noticed"; exit 1
}
