#!/usr/bin/env bash
# flash_look_ahead.sh SOURCE FOLDER: checks of tools/flash ssh with the new program on the machine,
# here a replacement: refused settings, no settings. Exit 77 = skipped.
set -euo pipefail
source=$(realpath "$1") folder=$2
# shellcheck source=tests/unit/tools/script_test.sh
. "$source/tests/unit/tools/script_test.sh"
need dpkg-deb
enter_folder
# shellcheck source=tests/unit/tools/made_up_package.sh
. "$source/tests/unit/tools/made_up_package.sh"
mkdir bin maps
printf '#!/bin/sh\n[ -e "%s/runs" ]\n' "$folder" >bin/systemctl
chmod 755 bin/systemctl
# The new program: prints the test's text, and logs its arguments.
program="#!/bin/sh
echo \"\$*\" >>$folder/asked
case \"\$1\" in
  --version) exit 0 ;;
  status) cat $folder/status; echo battery in use >&2; exit 1 ;;
esac
exit \$(cat $folder/check_code)"
spoil="mkdir ../bin; printf '%s\n' '$program' >../bin/bess-edge; chmod 755 ../bin/bess-edge"
package=$(made_up_package packages all 2.0)
touch edge.toml
look_ahead() {
  : >asked
  code=0
  PATH=$folder/bin:$PATH sh "$source/tools/delivery/flashing/look_ahead.sh" "$package" \
    "${settings:-edge.toml}" maps "$@" >out 2>err || code=$?
}
echo 0 >check_code
echo '{"health": "ok"}' >status
touch runs
look_ahead
[ $code -eq 0 ] || fail "a healthy machine: exit code $code, $(cat err)"

echo 'bess-edge: edge.toml:3: no such key' >status
look_ahead
[ $code -eq 1 ] || fail "refused settings: exit code $code"
grep -q "battery in use" err || fail "the new program's output is lost: $(cat err)"
rm runs
look_ahead
[ $code -eq 1 ] || fail "refused settings of a stopped controller: exit code $code"
# No controller: the new program connects to battery and price itself, which may be absent.
echo '{"health": "not running"}' >status
echo 1 >check_code
look_ahead
[ $code -eq 0 ] || fail "no controller: exit code $code"
grep -q -- --check err || fail "a check that fails is not told: $(cat err)"
grep -q -- "^--config edge.toml --check$" asked || fail "it was not checked: $(cat asked)"

settings=absent.toml look_ahead
[ $code -eq 0 ] || fail "no settings: exit code $code"
[ ! -s asked ] || fail "no settings, but a query: $(cat asked)"

[ $failures -eq 0 ] || exit 1
rm -rf "$folder"
echo "look ahead: settings"
