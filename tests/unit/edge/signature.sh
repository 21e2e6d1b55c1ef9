#!/bin/sh
# signature.sh EXPECTED [EMULATOR...] PROGRAM: fails if `bess-edge signature` (PROGRAM) does not
# print the line in the file EXPECTED, reports whether the student or the code has changed, and how
# to renew the file.
file=$1
shift
found=$("$@" signature) || { echo "$* signature: failed"; exit 1; }
expected=$(cat "$file" 2>/dev/null)
[ "$found" = "$expected" ] && exit 0
printf 'found     %s\nexpected  %s\n' "$found" "${expected:-nothing: there is no $file}"
if [ "${found%% *}" != "${expected%% *}" ]; then
  echo "The compiled student is not the one of the expected line," \
    "so its decisions have a signature of their own."
else
  echo "The same student decides otherwise: the code that decides has changed," \
    "or this machine computes otherwise."
fi
printf 'If that is meant, renew the line and commit it:\n  %s signature >%s\n' "$*" "$file"
exit 1
