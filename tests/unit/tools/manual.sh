#!/bin/bash
# manual.sh SOURCE FOLDER PROGRAM...: pages and completion contain the programs' --help.
source=$1 folder=$2
shift 2
fail() { echo "$*"; exit 1; }
command -v help2man >/dev/null || {
  echo "skipped: help2man is absent (tools/setup --test)"; exit 77
}
rm -rf "$folder"
export SOURCE_DATE_EPOCH=1700000000
"$source/tools/manual" --out "$folder/a" "$@" || fail "tools/manual fails"
"$source/tools/manual" --out "$folder/b" "$@" || fail "tools/manual fails"
diff -r "$folder/a" "$folder/b" || fail "the same programs give other pages"

check_page() {  # check_page COMMAND...: its page has every option of its help
  local name page option
  name=$(basename "$1") && name="$name${2:+-$2}${3:+-$3}"
  page=$folder/a/man1/$name.1
  [ -f "$page" ] || fail "$name has no page"
  for option in $("$@" --help | grep -o '^  \(-h,\)\?--[a-z0-9-]*' | sed 's/^ *\(-h,\)\?//'); do
    grep -qF -e "${option//-/\\-}" "$page" || fail "$name.1 does not know $option"
  done
  if command -v man >/dev/null; then
    [ -z "$(man --warnings -l "$page" 2>&1 >/dev/null)" ] ||
      fail "$name.1 is not clean: $(man --warnings -l "$page" 2>&1 >/dev/null)"
  fi
}
pages=0
for program in "$@"; do
  check_page "$program"
  pages=$((pages + 1))
  for sub in $("$program" --help | sed -n '/^[A-Z].*commands:$/,/^$/s/^  \([a-z]\+\) .*/\1/p'); do
    check_page "$program" "$sub"
    pages=$((pages + 1))
  done
done
[ $pages -gt $# ] || fail "no subcommand was looked at"

offered() {  # offered WORDS...: the completions of the last of them
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
  "_${1//-/_}"
  echo "${COMPREPLY[*]}"
}
expect() {  # expect WANTED WORDS...
  local wanted=$1 got
  shift
  got=$(offered "$@")
  [ "$got" = "$wanted" ] || fail "'$*': offers '$got', not '$wanted'"
}
for program in "$@"; do
  . "$folder/a/completions/$(basename "$program")" || fail "a completion is no bash"
done
expect "train" bess-train trai
expect "prices" bess-train pr
expect "fetch" bess-train prices fe
expect "--resume" bess-train run --out x --res
expect "minute" bess-train run --settlement mi
expect "" bess-train run --prices ma
expect "compare" bess-train runs co
expect "--fault-every" bess-sim battery --fault-ev
expect "commission" bess-edge comm
expect "--prometheus" bess-edge status --pro
