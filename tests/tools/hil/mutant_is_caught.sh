#!/bin/sh
# mutant_is_caught.sh PROGRAM SCENARIO RULE: fails unless the scenario fails on this defect, by this
# rule.
found=$("$1" run "$2" --json 2>/dev/null)
code=$?
[ $code -eq 1 ] || { echo "exit code $code: the defect was not caught by $2"; exit 1; }
printf '%s\n' "$found" | grep -q "\"rule\": *\"$3\"" || {
  echo "caught, but not by \"$3\": $found"; exit 1
}
