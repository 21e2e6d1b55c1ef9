#!/usr/bin/env bash
# flash_ssh.sh SOURCE FOLDER: tools/flash ssh with a replacement for ssh: its commands, and that
# each refusal is one line before anything is installed. Exit 77 = skipped.
set -euo pipefail
source=$(realpath "$1") folder=$2
# shellcheck source=tests/unit/tools/script_test.sh
. "$source/tests/unit/tools/script_test.sh"
need dpkg-deb
enter_folder
mkdir bin tmp
# shellcheck source=tests/unit/tools/made_up_package.sh
. "$source/tests/unit/tools/made_up_package.sh"
stand_in() { cat >"bin/$1" && chmod 755 "bin/$1"; }
export MACHINE=$folder/machine
mkdir -p "$MACHINE"
# The other machine: commands run here, with replacements for the programs they call.
stand_in ssh <<'SH'
#!/bin/sh
[ ! -e "$MACHINE/refuses" ] || { echo "ops@edge: Permission denied (publickey)." >&2; exit 255; }
while [ "$1" = -o ]; do shift 2; done
shift  # the host
PATH=$(dirname "$0")/there:$PATH exec sh -c "$*"
SH
mkdir bin/there
stand_in there/dpkg <<'SH'
#!/bin/sh
cat "$MACHINE/architecture"
SH
stand_in there/dpkg-query <<'SH'
#!/bin/sh
[ -e "$MACHINE/version" ] && printf 'ii %s' "$(cat "$MACHINE/version")"
SH
stand_in there/df <<'SH'
#!/bin/sh
echo "Filesystem 1024-blocks Used Available Capacity Mounted"
echo "/dev/x 9 9 $(cat "$MACHINE/free_kb") 9% /"
SH
stand_in there/systemctl <<'SH'
#!/bin/sh
echo inactive; exit 3
SH
stand_in there/sudo <<'SH'
#!/bin/sh
shift; exec "$@"
SH
stand_in there/apt-get <<'SH'
#!/bin/sh
echo "$*" >"$MACHINE/installed"
SH
stand_in there/cat <<'SH'
#!/bin/sh
case "$*" in */bess-update/state) exec /bin/cat "$MACHINE/state" ;; *) exec /bin/cat "$@" ;; esac
SH
stand_in there/mkdir <<'SH'
#!/bin/sh
exit 0
SH
stand_in there/tee <<'SH'
#!/bin/sh
exec /bin/cat >"$MACHINE/settings"
SH
stand_in there/mv <<'SH'
#!/bin/sh
case "$*" in *edge.toml*) exit 0 ;; *) exec /bin/mv "$@" ;; esac
SH
echo arm64 >machine/architecture
echo 5000000 >machine/free_kb
export BESS_SSH=$folder/bin/ssh BESS_FLASH_POLL_S=0.1
old=$(made_up_package packages arm64 1.0)
package=$(made_up_package packages arm64 2.0)
echo "control = false" >edge.toml
flash() { "$source/tools/flash" ssh ops@edge "$@" >said 2>&1; }

printf 'phase=confirmed\nversion=2.0\n' >machine/state
flash --package "$package" --config edge.toml || fail "an installation: $(cat said)"
grep -q -- "--force-confold /var/tmp/bess-edge-" machine/installed ||
  fail "apt-get was not asked: $(cat machine/installed)"
grep -q "2.0" said || fail "the confirmation is not reported: $(cat said)"
[ "$(cat machine/settings)" = "control = false" ] || fail "the settings were not sent"

rm machine/installed
printf 'phase=rolled_back\nversion=1.0\nrefused=2.0\nreason=the unit failed\n' >machine/state
code=0
flash --package "$package" --config edge.toml || code=$?
[ $code -eq 1 ] && grep -q "2\.0.*1\.0.*the unit failed" said ||
  fail "a roll-back, exit code $code: $(cat said)"

# The connection breaks during apt-get; the machine does not return. No local file remains.
mv bin/there/apt-get apt-get
printf '#!/bin/sh\nexit 255\n' >bin/there/apt-get
chmod 755 bin/there/apt-get
code=0
flash --package "$package" || code=$?
[ $code -eq 1 ] && grep -q "apt-get" said ||
  fail "a cut: exit code $code: $(cat said)"
mv apt-get bin/there/apt-get
rm machine/state
code=0
BESS_FLASH_POLL_S=0 TMPDIR=$folder/tmp flash --package "$package" --config edge.toml || code=$?
[ $code -eq 1 ] && grep -q "60 .*2.0" said ||
  fail "a host that dies: exit code $code: $(cat said)"
[ -z "$(ls tmp)" ] || fail "left behind: $(ls tmp)"
printf 'phase=confirmed\nversion=2.0\n' >machine/state

refuses() {  # refuses WHAT LINE ARGUMENTS...
  local what=$1 line=$2 code=0
  shift 2
  rm -f machine/installed
  flash "$@" || code=$?
  [ $code -eq 1 ] || fail "$what: exit code $code"
  [ "$(wc -l <said)" -eq 1 ] && grep -qF -- "$line" said || fail "$what: $(cat said)"
  [ ! -e machine/installed ] || fail "$what: something was installed"
}
touch machine/refuses
refuses "refused ssh" "Permission denied (publickey)" --package "$package"
rm machine/refuses
echo armhf >machine/architecture
refuses "another architecture" "tools/package armhf" --package "$package"
echo arm64 >machine/architecture
other=trixie mark=+deb13  # commands of the other machine run here: its release is this one's
! grep -q '^VERSION_CODENAME=trixie' /etc/os-release || other=bookworm mark=+deb12
refuses "another release" "$other" \
  --package "$(made_up_package packages arm64 "2.0$mark")"
echo 9000 >machine/free_kb
refuses "a full disk" "8 MB" --package "$package"
echo 5000000 >machine/free_kb
echo 2.0 >machine/version
refuses "an older version" "--force" --package "$old"
printf 'phase=confirmed\nversion=1.0\n' >machine/state
flash --package "$old" --force --no-wait || fail "--force: $(cat said)"
grep -q -- --allow-downgrades machine/installed || fail "--force does not reach apt-get"
spoil='echo >>student_weights.h'
refuses "a foreign certificate" header_sha256 \
  --package "$(made_up_package spoilt arm64 3.0)"
spoil='rm certificate.json'
spoil=''
truncated=$(made_up_package spoilt arm64 3.2)
truncate -s -200 "$truncated"
refuses "a truncated package" "${truncated##*/}" --package "$truncated"
"$source/tools/delivery/packaging/check_package" "$truncated" >said 2>&1 &&
  fail "a truncated package is handed on"
"$source/tools/delivery/packaging/check_package" "$package" ||
  fail "a good package is not handed on"
spoil='rm certificate.json'
refuses "no certificate" certificate.json \
  --package "$(made_up_package spoilt arm64 3.1)"
spoil=''
echo "no package" >noise.deb
refuses "no package" noise.deb --package noise.deb
refuses "a missing package" absent.deb --package absent.deb
code=0
flash --bogus || code=$?
[ $code -eq 2 ] || fail "an unknown option: exit code $code"

[ $failures -eq 0 ] || exit 1
rm -rf "$folder"
echo "ssh: installs and waits; all refusals"
