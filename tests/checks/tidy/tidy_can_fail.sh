#!/bin/sh
# tidy_can_fail.sh SOURCE FOLDER: tidy.py passes a small tree, and none with one defect.
set -eu
source=$1 tree=$2
rm -rf "$tree"
mkdir -p "$tree/edge/generated" "$tree/edge/device/maps" "$tree/tests/checks/tidy"
cp "$source"/edge/generated/* "$tree/edge/generated"
echo "1 edge/long.cpp" >"$tree/tests/checks/tidy/long_lines.txt"
long="// $(printf 'word %.0s' $(seq 30))"
echo "$long" >"$tree/edge/long.cpp"
printf '# tree\n`edge/` and `tests/`, proved over 6,950,033,280 inputs: `edge/long.cpp`\n' \
  >"$tree/README.md"
git -C "$tree" init -q
says() { git -C "$tree" add -A; "$source/tests/checks/tidy/tidy.py" "$tree" >"$tree/../said" 2>&1; }
says || { cat "$tree/../said"; echo "a tidy tree is refused"; exit 1; }
refused() {  # refused WHAT FILE TEXT: with TEXT as another line of FILE
  cp "$tree/README.md" "$tree/../README.md"
  mkdir -p "$(dirname "$tree/$2")"
  printf '%s\n' "$3" >>"$tree/$2"
  if says || ! grep -q "$1" "$tree/../said"; then
    cat "$tree/../said"
    echo "not found: $1"
    exit 1
  fi
  case $2 in
    edge/long.cpp) echo "$long" >"$tree/$2" ;;
    *) rm "$tree/$2" ;;
  esac
  cp "$tree/../README.md" "$tree/README.md"
}
refused "2 lines of more than 100 columns, 1 are known" edge/long.cpp "$long"
refused "a file of an unknown kind" edge/note.doc text
refused "README.md does not name it" other.txt text
refused "README.md: .* lines, 90 at most" README.md "$(seq 200)"
refused "links to edge/none.md, which is not there" README.md "[none](edge/none.md)"
refused "names edge/none.h, which is not there" README.md '`edge/none.h`'
refused "README.md: says 0123456789abcdef, the tree" README.md "signature=0123456789abcdef"
refused "README.md: says 6,950,033,281, the tree" README.md "6,950,033,281 states"
refused "names long/long.cpp, which is not there" README.md '`long/long.cpp`'
refused "names lang.cpp, which is not there" README.md '`lang.cpp`'
refused "edge/device/maps/README.md:1: begins with no heading" edge/device/maps/README.md \
  "#maps : device"
