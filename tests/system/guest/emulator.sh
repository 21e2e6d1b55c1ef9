# Sourced by tests/system/guest/emulated: one arm64 machine with its own kernel in
# qemu-system-aarch64, on a disk image. A cut kills the emulator: data that is not on disk is lost,
# as on a real machine.
#   make_arm64_base       FOLDER/arm64: Debian 12 arm64 with systemd, sshd and the simulators,
#                         configured by qemu's user mode in a separate user namespace, so that
#                         this machine registers no foreign programs
#   make_initrd           FOLDER/initrd: busybox and what the kernel needs to find its root on a
#                         virtio disk
#   boot IMAGE            starts it; returns when it answers by ssh
#   on COMMAND            as root inside;  cut_power;  shut_down
# They use $folder, $source and $programs (bess-sim for arm64).

# shellcheck source=tests/system/guest/site.sh
. "$source/tests/system/guest/site.sh"
die() { echo "${0##*/}: $*" >&2; exit 1; }
skip() { echo "${0##*/}: skipped: $*"; exit 77; }
sysroot=$source/build-sysroot-arm64
emulator="" port=$((20000 + $$ % 20000))

ssh_options=(-o BatchMode=yes -o StrictHostKeyChecking=no -o UserKnownHostsFile=/dev/null \
  -o LogLevel=ERROR)
ssh_options+=(-o ConnectTimeout=30 -i "$folder/key" -p "$port")
on() { ssh "${ssh_options[@]}" root@127.0.0.1 "$@"; }

# as_root_of_arm64 COMMAND...: root in a user namespace whose programs of arm64 run by qemu's user
# mode (Linux 6.7).
as_root_of_arm64() {
  local child i
  mkfifo "$folder/mapped"
  unshare --user --mount --propagation private bash -c 'read -r _ <"$0/mapped" &&
    mkdir -p "$0/binfmt" && mount -t binfmt_misc none "$0/binfmt" &&
    cat /usr/lib/binfmt.d/qemu-aarch64.conf >"$0/binfmt/register" && exec "$@"' \
    "$folder" "$@" &
  child=$!
  for ((i = 0; i < 300; ++i)); do
    [ "$(readlink "/proc/$child/ns/user")" = "$(readlink /proc/$$/ns/user)" ] || break
    sleep 0.1
  done
  { echo 0 0 65536 >/proc/$child/uid_map && echo 0 0 65536 >/proc/$child/gid_map; } 2>/dev/null ||
    true
  echo >"$folder/mapped"
  rm -f "$folder/mapped"
  wait $child
}

make_arm64_base() {
  local base=$folder/arm64 program
  for program in qemu-system-aarch64 qemu-aarch64-static mmdebstrap depmod cpio ssh; do
    command -v $program >/dev/null ||
      skip "$program is not installed; tools/setup --package installs it"
  done
  [ "$(id -u)" = 0 ] || skip "making its base needs root"
  mkdir -p "$folder"
  "$source/tools/sysroot" --boot || skip "no sysroot and kernel; see the lines above"
  [ -f "$folder/key" ] || ssh-keygen -q -t ed25519 -N "" -f "$folder/key"
  [ ! -d "$base" ] || return 0
  if [ ! -f "$folder/arm64.tar" ]; then
    as_root_of_arm64 mmdebstrap -q --format=tar --mode=root --arch=arm64 --skip=check/qemu \
      --variant=minbase \
      --include=systemd,systemd-sysv,udev,dbus,openssh-server,iproute2,procps,adduser,kmod \
      --include=ca-certificates bookworm "$folder/arm64.tar.new" \
      >"$folder/mmdebstrap.log" 2>&1 ||
      skip "no Debian arm64 can be made here: $(tail -n 1 "$folder/mmdebstrap.log")"
    mv "$folder/arm64.tar.new" "$folder/arm64.tar"
  fi
  rm -rf "$base.new"
  mkdir -p "$base.new"
  tar -C "$base.new" -xf "$folder/arm64.tar" --exclude=./dev/*
  rm -rf "$base.new"/var/lib/apt/lists/* "$base.new"/var/cache/apt/*.bin "$base.new"/etc/machine-id
  touch "$base.new/etc/machine-id"
  cp -a "$sysroot/boot/modules" "$base.new/lib/"
  depmod -b "$base.new" "$(ls "$sysroot/boot/modules")"
  printf '[Match]\nName=en* eth*\n[Network]\nDHCP=ipv4\n' \
    >"$base.new/etc/systemd/network/80-dhcp.network"
  ln -sf /lib/systemd/system/systemd-networkd.service \
    "$base.new/etc/systemd/system/multi-user.target.wants/"
  echo "/dev/vda2 / ext4 defaults 0 1" >"$base.new/etc/fstab"
  install -d -m 700 "$base.new/root/.ssh"
  install -m 600 "$folder/key.pub" "$base.new/root/.ssh/authorized_keys"
  site_into "$base.new"
  mkdir -p "$base.new/opt/bess-site/lib"
  libraries_of "$programs/bess-sim" "$base.new/opt/bess-site/lib"
  mv "$base.new" "$base"
}

# libraries_of PROGRAM FOLDER: its libraries except the C library, and their dependencies, from the
# sysroot.
libraries_of() {
  local name file
  for name in $(aarch64-linux-gnu-objdump -p "$1" | awk '$1 == "NEEDED" {print $2}' |
    grep -vE '^(libc|libm)\.so|^ld-linux'); do
    [ ! -e "$2/$name" ] || continue
    file=$(find "$sysroot/usr/lib/aarch64-linux-gnu" "$sysroot/lib/aarch64-linux-gnu/" -maxdepth 1 \
      -name "$name" | head -n 1)
    [ -n "$file" ] || die "$name, which ${1##*/} needs, is not in $sysroot"
    cp -L "$file" "$2/$name"
    libraries_of "$file" "$2"
  done
}

make_initrd() {
  local tree=$folder/initrd.tree version module
  version=$(ls "$sysroot/boot/modules")
  rm -rf "$tree"
  mkdir -p "$tree"/{bin,proc,sys,dev,root,modules}
  cp "$sysroot/boot/busybox" "$tree/bin/"
  ln -s busybox "$tree/bin/sh"
  for module in virtio_pci virtio_mmio virtio_blk ext4; do
    modprobe -d "$folder/arm64" -S "$version" --show-depends $module |
      awk '$1 == "insmod" {print $2}'
  done | awk '!seen[$1]++' >"$folder/modules"
  local n=10
  while read -r module; do
    cp "$module" "$tree/modules/$((n++))-${module##*/}"
  done <"$folder/modules"
  cat >"$tree/init" <<'SH'
#!/bin/sh
/bin/busybox --install -s /bin
mount -t proc proc /proc && mount -t sysfs sysfs /sys && mount -t devtmpfs dev /dev
for module in /modules/*; do insmod "$module"; done
until [ -b /dev/vda2 ]; do sleep 0.1; done
mount -t ext4 /dev/vda2 /root && umount /proc /sys && exec switch_root /root /sbin/init
exec sh
SH
  chmod 755 "$tree/init"
  (cd "$tree" && find . | cpio -o -H newc -R 0:0 --quiet) >"$folder/initrd"
}

boot() {
  local i
  qemu-system-aarch64 -M virt -cpu cortex-a53 -smp 2 -m 512 \
    -nographic -no-reboot -kernel "$sysroot/boot/vmlinuz" \
    -initrd "$folder/initrd" -append "console=ttyAMA0" \
    -drive "file=$1,format=raw,if=virtio,cache=writeback" \
    -netdev "user,id=net,hostfwd=tcp:127.0.0.1:$port-:22" \
    -device virtio-net-pci,netdev=net,romfile= \
    </dev/null >>"$folder/console" 2>&1 &
  emulator=$!
  for ((i = 0; i < 120; ++i)); do
    kill -0 $emulator 2>/dev/null || die "the emulator has ended: $(tail -n 2 "$folder/console")"
    on true 2>/dev/null && return 0
    sleep 2
  done
  die "the machine does not answer; its output is in $folder/console"
}
cut_power() {
  [ -n "$emulator" ] || return 0
  kill -9 $emulator 2>/dev/null || true
  wait $emulator 2>/dev/null || true
  emulator=""
}
shut_down() {
  on poweroff 2>/dev/null || true
  wait $emulator 2>/dev/null || true
  emulator=""
}
