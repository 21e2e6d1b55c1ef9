#!/bin/sh
# readme_commands_can_fail.sh SOURCE BUILD FOLDER: readme_commands.py passes a README that is right,
# and none with one mistake.
set -eu
source=$1 build=$2 tree=$3
for program in train edge sim hil page notify; do
  [ -x "$build/bess-$program" ] || { echo "needs bess-$program"; exit 77; }
done
rm -rf "$tree"
mkdir -p "$tree/tools"
printf '#!/bin/sh\n# tools/do --all\n' >"$tree/tools/do"
git -C "$tree" init -q
says() {
  git -C "$tree" add -A
  "$source/tests/checks/tidy/readme_commands.py" "$tree" "$build" >"$tree/../said" 2>&1
}
cat >"$tree/README.md" <<'END'
`bess-train prices fetch --from DATE`, `run --resume`, `--day-ahead`, `tools/do --all`.

    bess-edge --config FILE map check --against FILE | tee file    # --none is no option of it
    systemctl enable --now bess-edge

```console
$ seq 3; (sleep 100 &)
1
...
$ bess-edge --cycles x 2>/dev/null || echo "code  is $?"
code is ...
```
END
says || { cat "$tree/../said"; echo "a README that is right is refused"; exit 1; }
refused() {  # refused WHAT EXPRESSION: as changed by sed
  cp "$tree/README.md" "$tree/../README.md"
  sed -i "$2" "$tree/README.md"
  if says || ! grep -q "$1" "$tree/../said"; then
    cat "$tree/../said"
    echo "not found: $1"
    exit 1
  fi
  cp "$tree/../README.md" "$tree/README.md"
}
refused "README.md:1: bess-train prices fetch has no --form" 's/--from/--form/'
refused "README.md:1: bess-train prices has no fatch" 's/fetch/fatch/'
refused "README.md:1: bess-hil run has no --resum" 's/--resume/--resum/'
refused "README.md:1: this tree has no --day-behind" 's/--day-ahead/--day-behind/'
refused "README.md:1: tools/do has no --most" 's/--all/--most/'
refused "README.md:3: bess-edge map check has no --beside" 's/--against/--beside/'
refused "README.md:6: shows" 's/^code is/kode is/'
refused "README.md:6: shows" 's/^1$/2/'
refused "README.md:6: shows" 's/seq 3/seq 0/'
