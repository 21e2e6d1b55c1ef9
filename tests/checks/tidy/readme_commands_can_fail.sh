#!/bin/sh
# readme_commands_can_fail.sh SOURCE BUILD FOLDER: readme_commands.py passes a README and a
# guide that are right, and none with one mistake.
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
guide=shared/manual/guides/guide.md
mkdir -p "$tree/shared/manual/guides"
cat >"$tree/$guide" <<'END'
1. Write `bess-edge hold --for 2h`, then

   ```console
   $ cat >kept <<'KEPT'
   > two
   >   words
   > KEPT
   $ build/bess-edge --version | sed -n '1s/ .*//p'
   bess-edge
   ```

```sh
false    # is not run
```

```console
$ cat kept
two
  words
```
END
says || { cat "$tree/../said"; echo "what is right is refused"; exit 1; }
refused() {  # refused WHAT EXPRESSION [DOCUMENT]: as changed by sed
  where=$tree/${3:-README.md}
  cp "$where" "$tree/../kept.md"
  sed -i "$2" "$where"
  if says || ! grep -q "$1" "$tree/../said"; then
    cat "$tree/../said"
    echo "not found: $1"
    exit 1
  fi
  cp "$tree/../kept.md" "$where"
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
refused "$guide:1: bess-edge hold has no --till" 's/--for/--till/' "$guide"
refused "$guide:3: shows" 's/^   bess-edge$/   bess-page/' "$guide"
refused "$guide:16: shows" 's/^two$/three/' "$guide"
refused "$guide:16: shows" 's/^   > two$/   > one/' "$guide"
