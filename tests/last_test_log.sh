#!/bin/sh
# last_test_log.sh CTEST FOLDER: a failing test leaves its output in LastTest.log and its name in
# LastTestsFailed.log, also when time_outs.sh queries the same build for its tests during that run.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
rm -rf "$2"
mkdir -p "$2/build"
cat >"$2/build/CTestTestfile.cmake" <<TESTS
add_test(fails sh -c "echo what it was; exit 1")
add_test(lists sh $here/time_outs.sh $1 $2/build $2/list)
set_tests_properties(fails lists PROPERTIES TIMEOUT 60)
set_tests_properties(lists PROPERTIES DEPENDS fails)
TESTS
! "$1" --test-dir "$2/build" >"$2/said" 2>&1 || { echo "the failure is not noticed"; exit 1; }
grep -q '1 tests failed out of 2' "$2/said" || { cat "$2/said"; exit 1; }
for word in "fails LastTestsFailed" "what.it.was LastTest"; do
  grep -q "${word% *}" "$2/build/Testing/Temporary/${word#* }.log" ||
    { echo "${word#* }.log of the outer run is lost"; exit 1; }
done
