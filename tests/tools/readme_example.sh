#!/bin/sh
# readme_example.sh SOURCE BUILD FOLDER: runs the first example of tools/README.md as it is printed,
# in FOLDER, which stands for the top of the clone.
source=$1 build=$2 folder=$3
fail() { cat "$folder/said"; echo "$*"; exit 1; }
rm -rf "$folder"
mkdir -p "$folder/build"
ln -s "$source/edge" "$folder/edge"
ln -s "$build/bess-sim" "$build/bess-edge" "$folder/build"
{
  echo "trap 'kill \$(jobs -p) 2>/dev/null || true' EXIT"  # of an example that fails on its way
  sed -n '/^```sh$/,/^```$/{/^```$/q;/^```/d;p}' "$source/tools/README.md"
} >"$folder/example.sh"
grep -q bess-edge "$folder/example.sh" || fail "tools/README.md shows no example"
cd "$folder" || exit 1
sh -e example.sh >said 2>&1 || fail "the example fails"
grep -q "stopped: battery released" said || fail "the battery was not driven to the end"
rows=$(grep -c ",running," build/closed-loop/edge.csv)
[ "$rows" -ge 25 ] || fail "only $rows of 50 cycles were in control"
grep -q EUR said || fail "nothing was settled"
