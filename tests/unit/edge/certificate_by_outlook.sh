#!/bin/sh
# certificate_by_outlook.sh CERTIFICATE FOLDER: a package's certificate of a student by outlook
# names its context and the hash of its plan, and is refused with another program or plan.
certificate=$1
folder=$2
line=$(cat "$folder/decision_signature.txt")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$*"; exit 1; }
header=$folder/student_weights.h
"$certificate" make "$header" 1.0 abc "$line" >"$work/certificate.json" || fail "not made"
grep -q '"context": "outlook"' "$work/certificate.json" || fail "the context is not named"
"$certificate" check "$header" "$work/certificate.json" || fail "its own certificate is refused"
other=$(echo "$line" | sed 's/student=......../student=00000000/')
"$certificate" make "$header" 1.0 abc "$other" 2>/dev/null &&
  fail "a program with another student was certified"
sed 's/OUTLOOK_HASH 0x......../OUTLOOK_HASH 0x00000000/' "$header" >"$work/other.h"
"$certificate" check "$work/other.h" "$work/certificate.json" 2>/dev/null &&
  fail "a header with another plan passed"
exit 0
