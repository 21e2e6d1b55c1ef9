#!/usr/bin/env bash
# flash_image.sh SOURCE FOLDER: tools/flash image on synthetic images: the two partitions of
# Raspberry Pi OS with the few files that distinguish bookworm from trixie (the real images are not
# here). Needs no root. Exit 77 = skipped.
set -euo pipefail
source=$(realpath "$1") folder=$2
# shellcheck source=tests/unit/tools/script_test.sh
. "$source/tests/unit/tools/script_test.sh"
need sfdisk mcopy mformat debugfs mke2fs xz dpkg-deb apt-get
enter_folder
# shellcheck source=tests/unit/tools/made_up_package.sh
. "$source/tests/unit/tools/made_up_package.sh"

image_of() {  # image_of NAME CODENAME: FAT from sector 2048, 16 MiB; ext4 behind it, 64 MiB
  local tree=tree-$1
  mkdir -p "$tree/usr/lib/raspberrypi-sys-mods" "$tree/usr/bin" "$tree/var/lib/dpkg" \
    "$tree/etc/systemd/system"
  printf 'ID=debian\nVERSION_CODENAME=%s\n' "$2" >"$tree/usr/lib/os-release"
  for name in dpkg libc6 libcurl4; do
    printf 'Package: %s\nStatus: install ok installed\nArchitecture: arm64\nVersion: 9\n\n' $name
  done >"$tree/var/lib/dpkg/status"
  [ "${3:-}" != init_config ] || touch "$tree/usr/lib/raspberrypi-sys-mods/init_config"
  [ "${3:-}" != cloud-init ] || touch "$tree/usr/bin/cloud-init"
  truncate -s 81M "$1.img"
  printf 'label: dos\nstart=2048, size=32768, type=c\nstart=34816, size=131072, type=83\n' |
    sfdisk -q "$1.img"
  mformat -i "$1.img@@1048576" -T 32768 -h 16 -s 63 ::
  echo "console=tty1 root=PARTUUID=1-02 rootwait init=/usr/lib/raspberrypi-sys-mods/firstboot" |
    mcopy -i "$1.img@@1048576" - ::cmdline.txt
  mke2fs -q -t ext4 -d "$tree" -E offset=$((34816 * 512)) "$1.img" 64M
}
image_of bookworm bookworm init_config
image_of older bookworm
image_of trixie trixie cloud-init
image_of bullseye bullseye
image_of old_trixie trixie
package=$(made_up_package packages arm64 1.0)
echo "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIHJ1c3Q= ops" >key.pub
settings() {  # settings [LINE...]: required settings of the edge, and then these lines
  sed -e 's/^control = true/control = false/' -e '/^\[simulation\]/,$d' \
    "$source/tests/system/guest/edge.toml.in" >edge.toml
  [ $# -eq 0 ] || printf '%s\n' "$@" >>edge.toml
}
settings
echo 'pass "word' >wifi

flash() {
  "$source/tools/flash" image "$@" --host-name bess1 --user ops --ssh-key key.pub \
    --config edge.toml >said 2>&1
}
boot_file() { mcopy -n -i "$1@@1048576" "::$2" - 2>/dev/null; }
root_file() { debugfs -R "cat $2" "$1?offset=$((34816 * 512))" 2>/dev/null; }
expect() { grep -qF -- "$2" <<<"$1" || fail "$3: \"$2\" is not in: $1"; }

before=$(sha256sum bookworm.img)
flash bookworm.img --out out.img --package "$package" --wifi "the house" --wifi-password-file wifi \
  --wifi-country BE --ntp be.pool.ntp.org ||
  fail "bookworm: $(cat said)"
[ "$before" = "$(sha256sum bookworm.img)" ] || fail "the given image was changed"
custom=$(boot_file out.img custom.toml)
for line in 'hostname = "bess1"' 'name = "ops"' 'authorized_keys = ["ssh-ed25519 AAAA' \
  'timezone = "Europe/Brussels"' \
  'ssid = "the house"' 'password = "pass \"word"' 'country = "BE"'; do expect "$custom" "$line" \
  "bookworm's custom.toml"; done
python3 -c 'import tomllib, sys; tomllib.loads(sys.argv[1])' "$custom" ||
  fail "custom.toml is no TOML"
[ "$(root_file out.img /etc/bess/edge.toml)" = "$(cat edge.toml)" ] ||
  fail "the settings are not inside"
root_file out.img /var/lib/bess-first-boot/bess-edge_1.0_arm64.deb | cmp -s - "$package" ||
  fail "the package is not inside"
expect "$(root_file out.img /etc/systemd/timesyncd.conf.d/bess.conf)" "NTP=be.pool.ntp.org" "NTP"
stat_in() { debugfs -R "stat $1" "out.img?offset=$((34816 * 512))" 2>/dev/null; }
expect "$(stat_in /var/lib/bess-first-boot/install)" "Mode:  0755" "the installer's mode"
expect "$(stat_in /etc/systemd/system/multi-user.target.wants/bess-first-boot.service)" \
  "symlink" "the unit is enabled"

flash older.img --out out.img --package "$package" ||
  fail "bookworm without custom.toml's reader: $(cat said)"
expect "$(boot_file out.img firstrun.sh)" "set_hostname 'bess1'" "firstrun.sh"
expect "$(boot_file out.img cmdline.txt)" "systemd.run=/boot/firmware/firstrun.sh" "cmdline.txt"

xz -k0 trixie.img
flash trixie.img.xz --out out.img --package "$package" --wifi "the house" \
  --wifi-password-file wifi --wifi-country BE || fail "trixie: $(cat said)"
expect "$(boot_file out.img user-data)" 'hostname: "bess1"' "trixie's user-data"
expect "$(boot_file out.img network-config)" '"the house":' "trixie's network-config"
expect "$(boot_file out.img meta-data)" 'instance-id: bess-' "trixie's meta-data"
# Only on the boot partition: the system's own file is unchanged.
boot_file out.img bess/bess-edge_1.0_arm64.deb | cmp -s - "$package" ||
  fail "trixie: the package is not on the boot partition"
[ "$(boot_file out.img bess/edge.toml)" = "$(cat edge.toml)" ] ||
  fail "trixie: the settings are not on the boot partition"
expect "$(boot_file out.img bess/install)" "cd /boot/firmware/bess" "trixie's installer"
expect "$(boot_file out.img user-data)" "/boot/firmware/bess/start" \
  "trixie's user-data starts the installer"
boot_file out.img bess/install | sh -n || fail "trixie's installer is no shell"
cmp -s <(tail -c +$((34816 * 512 + 1)) out.img) <(tail -c +$((34816 * 512 + 1)) trixie.img) ||
  fail "trixie: the system partition was written"
if command -v cloud-init >/dev/null; then
  boot_file out.img user-data >user-data
  cloud-init schema --config-file user-data >said 2>&1 ||
    fail "cloud-init does not take user-data: $(cat said)"
fi
if python3 -c 'import yaml' 2>/dev/null; then
  boot_file out.img user-data | python3 -c '
import sys, yaml
found = yaml.safe_load(sys.stdin)
assert found["bootcmd"][0][:2] == ["sh", "-c"] and "bess/start" in found["bootcmd"][0][2], found
assert found["users"][0]["name"] == "ops" and found["timezone"] == "Europe/Brussels", found' ||
  fail "user-data is no YAML of cloud-init"
fi

refuses() {  # refuses WHAT LINE ARGUMENTS...: exit code 1, one line, nothing left
  local what=$1 line=$2 code=0
  shift 2
  rm -f none.img
  flash "$@" --out none.img || code=$?
  [ $code -eq 1 ] || fail "$what: exit code $code"
  [ "$(wc -l <said)" -eq 1 ] && grep -qF -- "$line" said || fail "$what: $(cat said)"
  [ ! -e none.img ] && [ ! -e none.img.new ] || fail "$what: files remain"
}
head -c 100000 /dev/urandom >noise.img
head -c $(($(stat -c %s trixie.img.xz) / 2)) trixie.img.xz >cut.img.xz
cp bookworm.img booted.img
echo "root=PARTUUID=1-02 rootwait" | mcopy -o -i booted.img@@1048576 - ::cmdline.txt
refuses "no image" "noise.img" noise.img --package "$package"
refuses "a truncated .xz" "cut.img.xz" cut.img.xz \
  --package "$package"
head -c 20000000 bookworm.img >cut.img
refuses "a truncated image" "cut.img" cut.img --package "$package"
refuses "a missing image" "absent.img" absent.img --package "$package"
refuses "another release" "bullseye" bullseye.img --package "$package"
refuses "trixie without cloud-init" "cloud-init" old_trixie.img --package "$package"
refuses "an image that was booted" cmdline.txt booted.img --package "$package"
for release in bookworm trixie; do
  mark=+deb12 other=trixie
  [ $release = bookworm ] || { mark=+deb13 other=bookworm; }
  marked=$(made_up_package packages arm64 "1.0$mark")
  flash $release.img --out out.img --package "$marked" --release $release ||
    fail "a package of $release: $(cat said)"
  refuses "a package of $release on $other" \
    "tools/package" $other.img \
    --package "$marked"
  refuses "an image of $other" "$other" $other.img \
    --package "$package" --release $release
done
refuses "another architecture" "armhf" bookworm.img \
  --package "$(made_up_package packages armhf 1.0)"
spoil='echo >>student_weights.h'
refuses "a header that was not proved" header_sha256 bookworm.img \
  --package "$(made_up_package spoilt arm64 1.1)"
spoil='rm certificate.json'
refuses "no certificate" "certificate" bookworm.img \
  --package "$(made_up_package spoilt arm64 1.2)"
spoil='sed -i "s/PROPERTY_3 0/PROPERTY_3 7/" student_weights.h'
refuses "violations" "[0, 0, 7]" bookworm.img \
  --package "$(made_up_package spoilt arm64 1.3)"
spoil=''
settings_refused() {  # settings_refused WHAT LINE: by the edge's reader, before anything is written
  refuses "$1" "$2" bookworm.img --package "$package"
  settings
}
if [ -x "${BESS_PROGRAMS:-$source/build}/bess-edge" ]; then
  settings '[guard]' 'unknown_key = 1'
  settings_refused "settings with a key that the edge does not know" "edge.toml:"
  settings '[guard]' 'soc_min = 7'
  settings_refused "settings with a value that the edge does not take" "edge.toml:"
fi
wifi_refused() {  # wifi_refused WHAT LINE PASSWORD COUNTRY
  printf '%s\n' "$3" >wifi
  refuses "$1" "$2" bookworm.img --package "$package" --wifi house --wifi-password-file wifi \
    --wifi-country "$4"
}
wifi_refused "a short Wi-Fi password" "WPA" seven77 BE
wifi_refused "a country of three letters" "--wifi-country BEL" "long enough" BEL
wifi_refused "a country in small letters" "--wifi-country be" "long enough" be
code=0
flash bookworm.img --out none.img --package "$package" --release bullseye || code=$?
[ $code -eq 2 ] && grep -q -- "--release.*bullseye" said ||
  fail "--release bullseye, exit code $code: $(cat said)"
code=0
"$source/tools/flash" image bookworm.img --out none.img --host-name bess1 --user root \
  --ssh-key key.pub --config edge.toml >said 2>&1 || code=$?
[ $code -eq 2 ] && grep -q -- "--user root" said ||
  fail "user root, exit code $code: $(cat said)"
printf 'control = = true\n' >edge.toml
refuses "settings that are no TOML" edge.toml bookworm.img --package "$package"
settings
cp bookworm.img none.img
before=$(sha256sum none.img)
code=0
flash none.img --out none.img --package "$package" || code=$?
[ $code -eq 1 ] && [ "$before" = "$(sha256sum none.img)" ] ||
  fail "an image over itself, exit code $code: $(cat said)"
code=0
flash bookworm.img --out absent/out.img --package "$package" || code=$?
[ $code -eq 1 ] && grep -q "absent/out.img" said ||
  fail "no folder for the image: $(cat said)"
# The archive is out of reach: a port without a server refuses apt immediately.
sed -i '/^Package: libcurl4$/,/^$/d' tree-bookworm/var/lib/dpkg/status
image_of lacking bookworm init_config 2>/dev/null || true
debugfs -w -R "rm /var/lib/dpkg/status" "lacking.img?offset=$((34816 * 512))" 2>/dev/null
debugfs -w -R "write tree-bookworm/var/lib/dpkg/status /var/lib/dpkg/status" \
  "lacking.img?offset=$((34816 * 512))" 2>/dev/null
export http_proxy=http://127.0.0.1:9
code=0
flash lacking.img --out none2.img --package "$package" || code=$?
unset http_proxy
[ $code -eq 1 ] && grep -q -- "--debs" said ||
  fail "no network, exit code $code: $(cat said)"
[ ! -e none2.img ] && [ ! -e none2.img.new ] || fail "no network: files remain"
echo "-----BEGIN OPENSSH PRIVATE KEY-----" >key.pub
refuses "a private key" "key.pub" bookworm.img --package "$package"

[ $failures -eq 0 ] || exit 1
rm -rf "$folder"
echo "images: bookworm with custom.toml and with firstrun.sh, trixie with cloud-init; all refusals"
