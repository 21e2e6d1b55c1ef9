#!/bin/sh
# watch_build.sh SOURCE FOLDER: tools/watch_build around builds that only take time or fail.
source=$1 folder=$2
fail() { cat "$folder/said" 2>/dev/null; echo "$*"; exit 1; }
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder" || exit 1
cat >slow <<'END'
echo "[1/2] Building CXX object one.o"
sleep 2.5
echo "[2/2] Linking CXX executable two"
END
cat >broken <<'END'
echo "[1/2] Building CXX object one.o"
echo "one.cpp:3:5: error: no such thing"
exit 1
END

WATCH_BUILD_EVERY_S=1 "$source/tools/watch_build" log sh slow >said 2>&1 ||
  fail "a successful build is reported as failed"
grep -q '^\[1/2\] compiled, ' said || fail "it shows no progress"
[ "$(tail -n 1 said)" = "[2/2] Linking CXX executable two" ] ||
  fail "it does not end with the build's last line"

"$source/tools/watch_build" log sh slow >said 2>&1 || fail "a slow build is reported as failed"
[ "$(wc -l <said)" -eq 1 ] || fail "more than a line a minute where there is no terminal"

"$source/tools/watch_build" log sh broken >said 2>&1 && fail "a failed build is reported as done"
grep -q '^one.cpp:3:5: error: no such thing' said || fail "the compiler's output is not shown"
grep -q '^\[1/2\]' said && fail "the steps before a failure are shown"

# On a terminal: one row, redrawn repeatedly.
script -qec "'$source/tools/watch_build' log sh slow" /dev/null >said 2>&1 ||
  fail "it fails on a terminal"
[ "$(grep -c . said)" -le 2 ] || fail "more than one row on a terminal"
grep -q "$(printf '\r')" said || fail "the row is not drawn again"
exit 0
