#!/usr/bin/env bash
# flash_device.sh SOURCE FOLDER: tools/flash device onto a loop device, and its refusals. Exit 77 =
# skipped.
set -euo pipefail
source=$(realpath "$1") folder=$2
# shellcheck source=tests/unit/tools/script_test.sh
. "$source/tests/unit/tools/script_test.sh"
need sfdisk bmaptool losetup mke2fs lsblk
[ "$(id -u)" = 0 ] || { echo "loop devices need root"; exit 77; }
enter_folder
mkdir mounted
truncate -s 24M os.img
printf 'label: dos\nstart=2048, size=8192, type=c\nstart=10240, type=83\n' | sfdisk -q os.img
mke2fs -q -t ext4 -E offset=$((10240 * 512)) os.img 16M
truncate -s 32M card.disk
truncate -s 8M small.disk
card=$(losetup -f --show card.disk) || { echo "no loop devices here"; exit 77; }
trap 'umount mounted 2>/dev/null || true; losetup -d "$card"
  [ -z "${small:-}" ] || losetup -d "$small"' EXIT
small=$(losetup -f --show small.disk)
flash() { "$source/tools/flash" device "$@" >said 2>&1; }

flash os.img "$card" --yes || fail "writing: $(cat said)"
grep -q "os.img" said || fail "the read-back is not reported: $(cat said)"
cmp -s -n "$(stat -c %s os.img)" os.img "$card" || fail "the card holds something else"
head -c 4096 card.disk >before
code=0
echo no | "$source/tools/flash" device os.img "$card" >said 2>&1 || code=$?
[ $code -eq 1 ] && cmp -s -n 4096 before card.disk ||
  fail "it ignores the answer no: $(cat said)"

refuses() {  # refuses WHAT LINE ARGUMENTS...
  local what=$1 line=$2 code=0
  shift 2
  flash "$@" --yes || code=$?
  [ $code -eq 1 ] || fail "$what: exit code $code"
  [ "$(wc -l <said)" -eq 1 ] && grep -qF -- "$line" said || fail "$what: $(cat said)"
}
head -c 100000 /dev/urandom >noise.img
refuses "no image" "noise.img" noise.img "$card"
refuses "a missing image" absent.img absent.img "$card"
refuses "no device" os.img os.img os.img
refuses "a small disk" "25 MB" os.img "$small"
mke2fs -q -F -t ext4 "$small"
if mount "$small" mounted 2>/dev/null; then
  refuses "a mounted disk" "$folder/mounted" os.img "$small"
  umount mounted
fi
system=$(findmnt -nro SOURCE / || true)  # nothing in a chroot
[ ! -b "$system" ] || refuses "the disk of the system" "$(realpath "$system"): " os.img "$system"

[ $failures -eq 0 ] || exit 1
cd / && umount "$folder/mounted" 2>/dev/null || true
echo "device: written and read back; all refusals"
