#!/bin/sh
# retrain.sh SOURCE BUILD FOLDER: retrains on the benchmark prices and adopts the result, then
# other thresholds from that run's teacher, in FOLDER, which acts as the top of a clone. Epochs are
# few; BESS_README_FULL=1 in the environment takes the default configuration.
source=$1 build=$2 folder=$3
fail() { tail -n 20 "$folder/said"; echo "$*"; exit 1; }
rm -rf "$folder"
mkdir -p "$folder/build"
for part in CMakeLists.txt edge shared toolchains; do cp -r "$source/$part" "$folder"; done
mkdir "$folder/tools" && cp -r "$source/tools/delivery/packaging" "$folder/tools"
cd "$folder" || exit 1
cmake -G Ninja -C toolchains/release.cmake -DBESS_WORKSTATION=OFF -DBESS_TESTS=OFF \
  -DBESS_NOTIFY=OFF -S . -B build >said 2>&1 ||
  fail "cannot be configured"
ln -s "$build/bess-train" build
cp "$source/tests/data/benchmark_minutes_2023.csv.gz" prices.csv.gz
header_before=$(cksum edge/generated/student_weights.h)

cat >flow.sh <<'END'
build/bess-train run --prices prices.csv.gz --out runs/first
build/bess-train export --student runs/first/student.json
cmake --build build --target bess-edge
build/bess-train run --prices prices.csv.gz --from-teacher runs/first --config my.toml \
  --out runs/mine
build/bess-train runs compare runs/first runs/mine
END
build/bess-train config >my.toml 2>said || fail "config fails"
sed -i -e 's/^low_price_eur_per_mwh = .*/low_price_eur_per_mwh = -300/' \
  -e 's/^high_price_eur_per_mwh = .*/high_price_eur_per_mwh = 1200/' my.toml
if [ -z "$BESS_README_FULL" ]; then
  printf '[distil]\nepochs = 60\n' >quick.toml
  sed -i 's/^epochs = .*/epochs = 60/' my.toml
  sed -i 's/--prices prices.csv.gz --out/--prices prices.csv.gz --config quick.toml --out/' flow.sh
fi
start=$(date +%s)
sh -e flow.sh >said 2>&1 || fail "the flow fails"
echo "the flow took $(($(date +%s) - start)) s"

[ "$(cksum edge/generated/student_weights.h)" != "$header_before" ] ||
  fail "no new header was exported"
grep -q 'signature=[0-9a-f]\{16\}$' edge/generated/decision_signature.txt ||
  fail "no signature: $(cat edge/generated/decision_signature.txt)"
[ "$(build/bess-edge signature)" = "$(cat edge/generated/decision_signature.txt)" ] ||
  fail "the build's decisions differ from the exported ones: $(build/bess-edge signature)"
grep -q '^#define BESS_STUDENT_TRAINED_FROM "2023-01-01"$' edge/generated/student_weights.h &&
  grep -q '^#define BESS_STUDENT_TRAINED_UNTIL "2023-05-22"$' edge/generated/student_weights.h ||
  fail "the header lacks its training days"
grep -q '[0-9]\.[0-9] .*wear_eur_per_mwh.*cycles_per_day_max' \
  runs/first/summary.txt || fail "the summary lacks the cycles"
grep -q 'warning:.*2023-05-22' said || fail "no warning of old prices"
[ "$(build/bess-edge signature)" != "$("$build/bess-edge" signature)" ] ||
  fail "bess-edge makes the old decisions"
grep -q 'low_price_eur_per_mwh.*-500.*-300' said ||
  fail "'runs compare' does not tell what differs"
grep -q '"low_price_eur_per_mwh":[[:space:]]*-300' runs/mine/student.json ||
  fail "the student is not bound to the new thresholds"
cmp -s runs/first/teacher.bin runs/mine/teacher.bin || fail "another teacher was used"
