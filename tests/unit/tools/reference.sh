#!/bin/sh
# reference.sh SOURCE BUILD FOLDER: the reference of the manual is what programs and code say now.
set -u
source=$1 build=$2 folder=$3
fail() { echo "$*"; exit 1; }
rm -rf "$folder"
mkdir -p "$folder"
"$source/tools/delivery/reference" "$build" --out "$folder" || exit $?
diff -r "$source/shared/manual/reference" "$folder" ||
  fail "shared/manual/reference is out of date: run tools/delivery/reference BUILD to update it"
"$source/tools/delivery/reference" "$build" --out "$folder" --compare ||
  fail "the same programs give another reference"
echo more >>"$folder/mqtt.md"
"$source/tools/delivery/reference" "$build" --out "$folder" --compare &&
  fail "--compare passes a changed file"
exit 0
