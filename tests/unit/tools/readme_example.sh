#!/bin/sh
# readme_example.sh SOURCE BUILD FOLDER: runs the closed loop of README.md as it is printed, but for
# its build, in FOLDER, which stands for the top of the clone.
source=$1 build=$2 folder=$3
fail() { cat "$folder/said"; echo "$*"; exit 1; }
rm -rf "$folder"
mkdir -p "$folder/build-edge"
ln -s "$source/edge" "$source/tests" "$folder"
ln -s "$build/bess-sim" "$build/bess-edge" "$build/bess-prices" "$folder/build-edge"
{
  echo "trap 'kill \$(jobs -p) 2>/dev/null || true' EXIT"  # of an example that fails on its way
  sed -n '/^```sh$/,/^```$/{/^```$/q;/^```/d;p}' "$source/README.md" | sed '1,/build build-edge$/d'
} >"$folder/example.sh"
grep -q bess-edge "$folder/example.sh" || fail "README.md shows no example"
cd "$folder" || exit 1
sh example.sh >said 2>&1 || fail "the example fails"
tail -n 1 build-edge/closed-loop/edge.csv | grep -q ",stopping," ||
  fail "the battery was not driven to the end"
rows=$(grep -c ",running," build-edge/closed-loop/edge.csv)
[ "$rows" -ge 25 ] || fail "only $rows of 50 cycles were in control"
# What status, why, earned and settle say, by their codes and numbers.
for word in '^state  *running' '^decided ' '^2023-03-11 .*%' "^battery's own record .* %"; do
  grep -q "$word" said || fail "no line $word"
done
