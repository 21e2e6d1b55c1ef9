#!/bin/sh
# rules_example.sh SOURCE BUILD FOLDER: runs the example of workstation/README.md, from a rule's
# text to the proved header, as it is printed, in FOLDER, which stands for the top of the clone. The
# header must hold the rule, and the teacher must be the one that was trained before there was a
# rule. Without BESS_README_FULL=1 in the environment: a teacher of 100 steps, and
# neither the distillation nor what follows it.
source=$1 build=$2 folder=$3
fail() { tail -n 40 "$folder/said"; echo "$*"; exit 1; }
rm -rf "$folder"
mkdir -p "$folder/build"
ln -s "$build/bess-train" "$folder/build"
sed -n '/^```sh$/,/^```$/{/^```/d;p}' "$source/workstation/README.md" |
  sed 's/\(train --prices.*\)/\1 \&\& cp teacher.bin before.bin/' >"$folder/example.sh"
grep -q "rules check" "$folder/example.sh" || fail "workstation/README.md shows no example"
cd "$folder" || exit 1
grep -q "^build/bess-train export .*student_weights.h" example.sh ||
  fail "the example ends with no header"
[ -n "$BESS_README_FULL" ] ||
  sed -i 's/ train / train --steps 100 /; /^build\/bess-train distil /,$d' example.sh
sh -e example.sh >said 2>&1 || fail "the example fails"
cmp -s teacher.bin before.bin || fail "the teacher was touched"
grep -q '^no dear charging  *student and guard  *price at least 301' said ||
  fail "the rule binds student and guard"
grep -q '^no dear charging  *[-+][0-9.]* ' said || fail "the rule has no price"
[ -n "$BESS_README_FULL" ] || exit 0
header=student/student_weights.h
grep -q -- "-  no dear charging: .*(the guard's too)" $header ||
  fail "the certificate does not name the rule"
grep -q "BESS_STUDENT_GUARD_RULE_COUNT 1" $header || fail "the guard has no table"
grep -q 'rule "no dear charging".*: 0 violations in 4167936000' said ||
  fail "the rule was not proved"
