#!/bin/sh
# every_kind.sh SOURCE BUILD FOLDER [PRICES]: students with every kind of rule that
# the manual documents, trained and proved; prints their proofs, and their cost with its
# error: projected, then trained. PRICES: a minute file; without it a simulated year. The rules of a
# file of kinds/ together, one seed; with BESS_THOROUGH=1 three seeds. Fails after all reports if a
# student is not proved.
source=$(cd "$1" && pwd) build=$(cd "$2" && pwd) folder=$3
[ -z "$4" ] || set -- "$1" "$2" "$3" "$(realpath "$4")"
train=$build/bess-train
kinds=$source/tests/unit/workstation/correction/rules/kinds
seeds=1
[ -z "$BESS_THOROUGH" ] || seeds="1 2 3"
mkdir -p "$folder" && cd "$folder" || exit 1
prices=${4:-market.csv.gz}
[ -n "$4" ] || "$train" prices simulate --days 365 --out "$prices" >said || exit 1
printf '[train]\ncontext = "month"\n' >month.toml

status=0
fails() {
  status=1
  sed -n '/^bess-train: /,$p' said
}
learn() {  # SET [--config FILE]
  set=$1
  shift
  "$train" train --prices "$prices" "$@" --out teacher.bin 2>said || { cat said; exit 1; }
  printf '\n== %s\n' "$set"
  "$train" rules price --prices "$prices" --policy teacher.bin --rules "$kinds/$set.toml" "$@" \
    2>said || fails
  for seed in $seeds; do
    set -- --prices "$prices" "$@"
    "$train" distil "$@" --teacher teacher.bin --seed "$seed" --out without.json 2>said &&
      "$train" distil "$@" --teacher teacher.bin --seed "$seed" --out with.json \
        --rules "$kinds/$set.toml" 2>said &&
      "$train" evaluate "$@" --split val+test --policy without.json with.json 2>said || fails
    shift 2
  done
}
learn states
learn months --config month.toml
learn falls
learn rises
exit $status
