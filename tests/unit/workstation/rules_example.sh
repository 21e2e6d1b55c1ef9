#!/bin/sh
# rules_example.sh SOURCE BUILD FOLDER: from the text of a rule to the proved header, in FOLDER. The
# header must hold the rule, and the teacher must not be touched. Without BESS_README_FULL=1 in the
# environment: a teacher of 100 steps, and neither distillation nor export.
build=$2 folder=$3
fail() { tail -n 40 "$folder/said"; echo "$*"; exit 1; }
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder" || exit 1
PATH=$build:$PATH
cat >my_rules.toml <<'END'
[[rule]]
name = "no expensive charging"
price_min = 301
at_most = "idle"
enforce = true
END
steps=
[ -n "$BESS_README_FULL" ] || steps="--steps 100"
prepare() {
  bess-train prices simulate --days 365 --out market.csv.gz &&
    bess-train train --prices market.csv.gz $steps --out teacher.bin &&
    cp teacher.bin before.bin &&
    bess-train rules check --rules my_rules.toml &&
    bess-train rules price --rules my_rules.toml --prices market.csv.gz --policy teacher.bin
}
finish() {
  bess-train distil --prices market.csv.gz --teacher teacher.bin --rules my_rules.toml \
    --out student.json &&
    bess-train export --student student.json --out student/student_weights.h
}
prepare >said 2>&1 || fail "the example fails"
cmp -s teacher.bin before.bin || fail "the teacher was touched"
grep -q '^no expensive charging .*guard.*301' said ||
  fail "the rule binds student and guard"
grep -q '^no expensive charging  *[-+][0-9.]* ' said || fail "the rule has no price"
[ -n "$BESS_README_FULL" ] || exit 0
finish >>said 2>&1 || fail "the example fails"
cmp -s teacher.bin before.bin || fail "the teacher was touched"
header=student/student_weights.h
grep -q -- "no expensive charging.*guard" $header ||
  fail "the certificate does not name the rule"
grep -q "BESS_STUDENT_GUARD_RULE_COUNT 1" $header || fail "the guard has no table"
grep -q '"no expensive charging".* 0 .*4167936000' said ||
  fail "the rule was not proved"
