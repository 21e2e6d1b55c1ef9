#!/bin/sh
# held.sh FOLDER: list_skips.py accepts only the known reasons, and no skip without a reason.
set -eu
folder=$1
mkdir -p "$folder"
here=$(dirname "$0")
# run_of NAME TEXT: a run of ctest with one test that passed and one that was skipped with TEXT
run_of() {
  cat >"$folder/$1.xml" <<XML
<testsuite><testcase name="Passes"><system-out>[  SKIPPED ] is only a word here</system-out></testcase>
<testcase name="Skips"><skipped message="x"/><system-out>$2</system-out></testcase></testsuite>
XML
}
run_of known "/a/b_test.cpp:2: Skipped
needs root, to mount a small disk
[  SKIPPED ] Skips (0 ms)"
run_of script "socat is not installed"
run_of silent ""
"$here/list_skips.py" "$here/known.txt" "$folder/known.xml" |
  grep -q '^skipped: needs root, to mount a small disk: Skips$'
for name in script silent; do
  if "$here/list_skips.py" "$here/known.txt" "$folder/known.xml" "$folder/$name.xml" \
    >"$folder/said" 2>&1; then
    echo "the skip \"$name\" was accepted"
    exit 1
  fi
  grep -q '^SKIPPED, for no known reason' "$folder/said"
done
