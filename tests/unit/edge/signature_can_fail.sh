#!/bin/sh
# signature_can_fail.sh FOLDER [EMULATOR...] PROGRAM: signature.sh passes the correct line only,
# distinguishes another student from other decisions, and names a command that renews the file.
folder=$1
shift
fail() { echo "$*"; exit 1; }
rm -rf "$folder" && mkdir -p "$folder" || exit 1
line=$("$@" signature) || fail "$* signature: failed"
check() { sh "${0%/*}/signature.sh" "$folder/expected" "$@"; }
refused() {  # signature.sh fails, gives $why, and its command renews the file
  said=$(check "$@") && fail "signature.sh passed: $(cat "$folder/expected")"
  printf '%s\n' "$said" | grep -q "$why" || fail "signature.sh did not say \"$why\": $said"
  sh -c "$(printf '%s\n' "$said" | tail -n 1)" || fail "the command that renews the file failed"
  check "$@" || fail "the renewed file is refused"
}
why="there is no $folder/expected" refused "$@"
printf '%s\n' "$line" | sed 's/^student=......../student=00000000/' >"$folder/expected"
why="The compiled student is not the one" refused "$@"
printf '%s\n' "$line" | sed 's/signature=................/signature=0000000000000000/' \
  >"$folder/expected"
why="The same student decides otherwise" refused "$@"
rm -rf "$folder"
