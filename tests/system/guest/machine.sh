# Sourced by the tests of tests/system/guest: machines with systemd as their first process, in
# containers (systemd-nspawn): Debian of this processor and of the release that $package is for,
# with the simulators inside, no network except loopback. Needs root.
#   make_base             base of all machines, made once: $guest, of $release
#   boot NAME             starts a machine over a copy of it (made if absent)
#   on NAME COMMAND       as root inside;  send NAME FILE PLACE
#   play OPTION...        the Ansible roll-out; its exit code is in $code, its output in ansible.log
#   cut_power NAME        kills every process of the machine;  shut_down NAME
#   forget NAME
# They use $folder, $source and $programs (folder of bess-sim). The kernel is this machine's: a cut
# kills all processes of a machine, but unsynchronised writes are not lost.

# shellcheck source=tests/system/guest/site.sh
. "$source/tests/system/guest/site.sh"
# shellcheck source=tools/delivery/packaging/release.sh
. "$source/tools/delivery/packaging/release.sh"
die() { echo "${0##*/}: $*" >&2; exit 1; }
skip() { echo "${0##*/}: skipped: $*"; exit 77; }
declare -A container first

on() {
  local name=$1
  shift
  nsenter -t "${first[$name]}" -m -u -i -n -p -C -r -w env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin \
    HOME=/root LC_ALL=C.UTF-8 sh -c "$*"
}
send() { on "$1" "cat >$3" <"$2"; }

play() {
  code=0
  ANSIBLE_SSH_EXECUTABLE=$BESS_SSH ANSIBLE_SSH_TRANSFER_METHOD=piped ANSIBLE_SSH_ARGS="" \
    ANSIBLE_PYTHON_INTERPRETER=/usr/bin/python3 ANSIBLE_NOCOLOR=1 LC_ALL=C.UTF-8 \
    ansible-playbook "$@" "$source/tools/delivery/ansible/roll_out.yml" \
    -e bess_confirm_retries=300 -e bess_confirm_delay_s=1 >"$folder/ansible.log" 2>&1 || code=$?
}

make_base() {
  local program httplib=libcpp-httplib0.11
  release=$(release_of "$package")
  release=${release:-$own_release}
  [ $release = bookworm ] || httplib=libcpp-httplib0.18
  guest=$folder/base-$release
  local tar=$folder/root-$release.tar
  for program in systemd-nspawn mmdebstrap nsenter; do
    command -v $program >/dev/null ||
      skip "$program is not installed; tools/setup --package installs it"
  done
  [ "$(id -u)" = 0 ] || skip "machines need root"
  mkdir -p "$folder"
  # Left by an older test, without the files of this one.
  [ ! -d "$guest" ] || [ -d "$guest/usr/share/doc/$httplib" ] ||
    rm -rf "$guest" "$tar"
  if [ -d "$guest" ] &&
    cmp -s "$source/tests/system/guest/start_site" "$guest/opt/bess-site/start_site" &&
    cmp -s "$programs/bess-sim" "$guest/opt/bess-site/bess-sim"; then
    return 0
  fi
  if [ ! -f "$tar" ]; then
    mmdebstrap -q --variant=minbase --include=systemd,systemd-sysv,udev,dbus,libcurl4,libcjson1 \
      --include=libmodbus5,libmosquitto1,$httplib,ca-certificates,adduser,python3 \
      --include=iproute2,procps,unattended-upgrades \
      $release "$tar" >"$folder/mmdebstrap.log" 2>&1 ||
      skip "no Debian archive: $(tail -n 1 "$folder/mmdebstrap.log")"
  fi
  rm -rf "$guest.new"
  mkdir -p "$guest.new"
  tar -C "$guest.new" -xf "$tar"
  rm -rf "$guest.new"/boot/*
  site_into "$guest.new"
  # Upgrades only start when a test starts them.
  for program in apt-daily.timer apt-daily-upgrade.timer unattended-upgrades.service; do
    ln -sf /dev/null "$guest.new/etc/systemd/system/$program"
  done
  ldd "$programs/bess-sim" | awk '$3 ~ /^\// {print $3}' | grep -vE '/(libc|libm)\.so' |
    xargs -I{} cp -L {} "$guest.new/opt/bess-site/lib/"
  rm -rf "$guest"
  mv "$guest.new" "$guest"
}

boot() {
  local machine=$folder/$1 i
  if [ ! -d "$machine" ]; then mkdir -p "$machine"/{upper,work,root}; fi
  mountpoint -q "$machine/root" ||
    mount -t overlay overlay \
      -o "lowerdir=$guest,upperdir=$machine/upper,workdir=$machine/work" "$machine/root" ||
    skip "no overlay file system here"
  systemd-nspawn -q -D "$machine/root" -b --machine="bess-$1-$$" --register=no \
    --keep-unit --private-network --console=pipe \
    </dev/null >"$machine/console" 2>&1 &
  container[$1]=$!
  for ((i = 0; i < 600; ++i)); do
    first[$1]=$(pgrep -P "${container[$1]}" -f systemd 2>/dev/null | head -n 1 || true)
    echo "${first[$1]}" >"$machine/first"
    [ -n "${first[$1]}" ] &&
      on "$1" 'systemctl is-system-running 2>/dev/null | grep -qE "running|degraded"' 2>/dev/null &&
      return 0
    kill -0 "${container[$1]}" 2>/dev/null ||
      skip "a container with systemd does not start here: $(tail -n 1 "$machine/console")"
    sleep 0.2
  done
  die "$1 did not start within two minutes"
}
cut_power() {
  rm -f "$folder/$1/first"
  kill -9 "${first[$1]}" "${container[$1]}" 2>/dev/null || true
  wait "${container[$1]}" 2>/dev/null || true
}
shut_down() {
  kill -RTMIN+4 "${first[$1]}" 2>/dev/null || true
  wait "${container[$1]}" 2>/dev/null || true
}
forget() {
  umount -l "$folder/$1/root" 2>/dev/null || true
  rm -rf "${folder:?}/$1"
}
