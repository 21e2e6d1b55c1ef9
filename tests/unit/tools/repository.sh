#!/usr/bin/env bash
# repository.sh SOURCE FOLDER: tools/repository with a temporary key: apt accepts its signature, the
# share of twenty machines that upgrade equals the phase, and a foreign key is refused. Exit 77 =
# skipped.
set -euo pipefail
source=$(realpath "$1") folder=$2
# shellcheck source=tests/unit/tools/script_test.sh
. "$source/tests/unit/tools/script_test.sh"
need aptly apt-ftparchive gpg apt-get dpkg-deb
enter_folder
# shellcheck source=tests/unit/tools/made_up_package.sh
. "$source/tests/unit/tools/made_up_package.sh"
GNUPGHOME=$(mktemp -d)  # a short path: gpg's agent listens at a socket in it
export GNUPGHOME
trap 'gpgconf --kill gpg-agent; rm -rf "$GNUPGHOME"' EXIT
for name in first second; do
  gpg --batch --quiet --pinentry-mode loopback --passphrase '' \
    --quick-generate-key "$name@example.org" ed25519 sign 2>/dev/null
done
made_up_package packages amd64 1.0 >/dev/null
export BESS_PACKAGES=$folder/packages
repository() { "$source/tools/package" --repository repository "$@" >said 2>&1; }

code=0
repository --key absent@example.org || code=$?
[ $code -eq 1 ] && grep -q absent@example.org said ||
  fail "a key that is not there: $(cat said)"
repository --key first@example.org || fail "a repository: $(cat said)"
made_up_package packages amd64 2.0 >/dev/null
repository --key first@example.org --phased 30 || fail "a newer version: $(cat said)"
code=0
repository --key second@example.org || code=$?
known=$(gpg --batch --with-colons --list-keys first@example.org |
  awk -F: '$1 == "fpr" && !found++ { print $10 }')
[ $code -eq 1 ] && grep -q "$known" said || fail "another key: $(cat said)"
# A refused package leaves the served ones unchanged.
export BESS_PACKAGES=$folder/spoilt
refuses() {  # refuses WHAT LINE OPTIONS...
  local what=$1 line=$2 code=0 before
  before=$(cat repository/dists/stable/InRelease | sha256sum)
  shift 2
  repository --key first@example.org "$@" || code=$?
  [ $code -eq 1 ] && grep -qF -- "$line" said || fail "$what: exit code $code: $(cat said)"
  [ "$before" = "$(cat repository/dists/stable/InRelease | sha256sum)" ] ||
    fail "$what: the repository was changed"
  rm -rf spoilt
}
file=$(made_up_package spoilt amd64 3.0) && truncate -s -200 "$file"
refuses "a truncated package" "${file##*/}"
spoil='echo >>student_weights.h' made_up_package spoilt amd64 3.0 >/dev/null
refuses "a foreign certificate" header_sha256
spoil='echo other >>notes' made_up_package spoilt amd64 2.0 >/dev/null
refuses "the same version with other bytes" "2.0"
made_up_package spoilt amd64 0.9 >/dev/null
refuses "an older version" "--older"
made_up_package spoilt amd64 3.0 >/dev/null
mkdir no_gpg && printf '#!/bin/sh\ncase "$*" in *--clearsign*) exit 2 ;; esac\nexec %s "$@"\n' \
  "$(command -v gpg)" >no_gpg/gpg && chmod 755 no_gpg/gpg
PATH=$folder/no_gpg:$PATH refuses "a key that does not sign" gpg
packages_now() {
  grep -h ^Version: repository/dists/stable/main/binary-amd64/Packages | sort | tr '\n' ' '
}
made_up_package spoilt amd64 0.8 >/dev/null
repository --key first@example.org --older --phased 30 ||
  fail "an older version, with the word: $(cat said)"
[ "$(packages_now)" = "Version: 0.8 Version: 1.0 Version: 2.0 " ] ||
  fail "after refusals there is: $(packages_now)"
export BESS_PACKAGES=$folder/packages
code=0
repository --key first@example.org --phased 130 || code=$?
[ $code -eq 2 ] || fail "130 percent: exit code $code"
of_two() {
  BESS_PACKAGES=$folder/marked "$source/tools/package" --repository of_two \
    --key first@example.org >said 2>&1
}
made_up_package marked amd64 1.0+deb12 >/dev/null
of_two || fail "packages of bookworm: $(cat said)"
made_up_package marked amd64 2.0+deb13 >/dev/null
if of_two || ! grep -q "+deb12" said; then
  fail "packages of two releases: $(cat said)"
fi

# A machine with 1.0 and this machine id; prints apt's action.
mkdir -p apt/{lists/partial,archives/partial,parts}
installed() {  # installed NAME VERSION: a paragraph of dpkg's status
  printf '%s\n' "Package: $1" "Status: install ok installed" "Version: $2" "Architecture: amd64" \
    "Maintainer: x <x@example.org>" "Description: x" ""
}
installed bess-edge 1.0 >apt/status
for name in libc6 libcurl4; do
  installed $name 9 >>apt/status
done
sources() {
  echo "deb [signed-by=$folder/$1] file:$folder/repository ${2:-stable} main" >apt/sources.list
}
apt() {
  apt-get -o Dir::Etc::SourceList="$folder/apt/sources.list" \
    -o Dir::Etc::SourceParts="$folder/apt/parts" -o Dir::State="$folder/apt" \
    -o Dir::State::Lists="$folder/apt/lists" -o Dir::State::Status="$folder/apt/status" \
    -o Dir::Cache="$folder/apt" -o APT::Sandbox::User=root \
    -o Dir::Etc::Preferences=/dev/null -o Dir::Etc::PreferencesParts="$folder/apt/parts" \
    -o APT::Architecture=amd64 "$@"
}
gpg --batch --export second@example.org >other.gpg
sources other.gpg
if apt update -o APT::Update::Error-Mode=any >said 2>&1; then
  fail "apt accepts a repository with a foreign key"
fi
sources repository/bess.gpg
apt update >said 2>&1 || fail "apt refuses the repository: $(tail -n 2 said)"
upgrades() {  # of twenty machines
  local number=0 id
  for id in $(seq 1 20); do
    if apt upgrade -s -o APT::Machine-ID="$(printf '%032x' "$id")" 2>/dev/null |
      grep -q '^Inst bess-edge'; then
      number=$((number + 1))
    fi
  done
  echo $number
}
some=$(upgrades)
{ [ "$some" -gt 0 ] && [ "$some" -lt 14 ]; } || fail "at 30 % $some of 20 machines upgrade"
# A new machine is not an upgrade: no percentage withholds the newest version from it. The suite of
# full versions does.
cp apt/status apt/status.kept
awk 'BEGIN { RS = ""; ORS = "\n\n" } !/^Package: bess-edge\n/' apt/status.kept >apt/status
for suite in stable full; do
  sources repository/bess.gpg $suite
  apt update >said 2>&1 || fail "apt refuses $suite: $(tail -n 2 said)"
  apt install -s bess-edge 2>/dev/null |
    sed -n "s/^Inst bess-edge (\([^ ]*\).*/$suite \1/p" >>new_machines
done
[ "$(cat new_machines)" = "stable 2.0
full 1.0" ] || fail "new machines get $(tr '\n' ' ' <new_machines)"
mv apt/status.kept apt/status
sources repository/bess.gpg
repository --key first@example.org --phased 0 && apt update >said 2>&1
none=$(upgrades)
[ "$none" -eq 0 ] || fail "at 0 % $none of 20 machines upgrade"
repository --key first@example.org && apt update >said 2>&1
all=$(upgrades)
[ "$all" -eq 20 ] || fail "at 100 % $all of 20 machines upgrade"

# A newer version is withdrawn: the previous one is served again, and no package is lost.
made_up_package packages amd64 3.0 >/dev/null
repository --key first@example.org || fail "a newer one: $(cat said)"
apt update >said 2>&1
apt upgrade -s 2>/dev/null | grep -q '^Inst bess-edge .*(3.0 ' || fail "3.0 is not served"
repository --key first@example.org --back || fail "back: $(cat said)"
apt update >said 2>&1 || fail "apt refuses the previous index: $(tail -n 2 said)"
apt upgrade -s 2>/dev/null | grep -q '^Inst bess-edge .*(2.0 ' || fail "2.0 is not served again"
apt install -s bess-edge=1.0 >said 2>&1 || fail "the version before is gone: $(tail -n 1 said)"
code=0
for _ in 1 2 3 4 5 6 7 8; do repository --key first@example.org --back || { code=$?; break; }; done
[ $code -eq 1 ] && grep -q snapshot said ||
  fail "back beyond the first: $code $(cat said)"

[ $failures -eq 0 ] || exit 1
cd / && rm -rf "$folder"
echo "repository: at 0, 30, 100 % $none, $some, $all of 20 machines would upgrade;" \
  "a foreign key is refused"
