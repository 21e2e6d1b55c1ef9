#!/bin/sh
# probation.sh FOLDER: bess-probation on simulated machines (folders), with replacements for systemd
# and the versions' programs. Bad packages and bad moments: in the end the working version runs, or
# the new one has proved that it works. Prints a table.
folder=${1:?the folder is missing: without it the stand-ins would go into /bin}
script=$(cd "$(dirname "$0")/../../../../.." && pwd)/edge/delivery/package/bess-probation
failures=0
[ ! -e "$folder" ] || [ -x "$folder/bin/systemctl" ] || {
  echo "$folder exists and is not of this test"; exit 2
}
rm -rf "$folder"
mkdir -p "$folder/bin"
fail() { echo "FAILED: $*"; failures=$((failures + 1)); }
stand_in() { cat >"$folder/bin/$1" && chmod 755 "$folder/bin/$1"; }
stand_in systemctl <<'SH'
#!/bin/sh
cd "$BESS_ROOT/fake" || exit 1
echo "$*" >>systemctl
started() {
  basename "$(readlink "$BESS_ROOT/var/lib/bess-edge/current")" >running
  echo 0 >cycle; echo active >active
}
case "$*" in
  *ActiveState*) cat active ;;
  *NRestarts*)  # a crashing program is restarted repeatedly
    if [ "$(cat "does_$(cat running)" 2>/dev/null)" = crash ]; then
      echo $(($(cat restarts) + 2)) >restarts
    fi
    cat restarts ;;
  *is-active*) [ "$(cat active)" = active ] ;;
  reload*) echo $(($(cat restarts) + 1)) >restarts; started ;;
  *restart*bess-edge* | start*bess-edge*) started ;;
  stop*) echo inactive >active; : >running ;;
esac
SH
stand_in cp <<'SH'
#!/bin/sh
[ ! -e "$BESS_ROOT/fake/no_room" ] || { echo "cp: No space left on device" >&2; exit 1; }
exec /bin/cp "$@"
SH
export PATH="$folder/bin:$PATH"

# A version's program: reports the log's contents, as the real one does.
version_into() {  # version_into PLACE VERSION [COMMAND in its folder BEFORE SUMS] [AFTER]
  mkdir -p "$1/bin" "$1/share/maps" "$1/systemd"
  cat >"$1/bin/bess-edge" <<SH
#!/bin/sh
case "\$1" in
  signature) echo "student=45d2cbe3 decisions=1 signature=1b13" ;;
  --self-test)
    ! grep -q unknown_key "\$3" || { echo "bess-edge: \$3:1: unknown key" >&2; exit 1; }
    printf 'student    ok    x\nnetwork    FAIL  away\nself-test  1 part(s) failed\n'; exit 1 ;;
  log) cat "\$BESS_ROOT/fake/log.csv" ;;
esac
SH
  chmod 755 "$1/bin/bess-edge"
  echo "map of $2" >"$1/share/maps/alphaess.toml"
  echo "header of $2" >"$1/share/student_weights.h"
  printf '{"version": "%s", "student": "45d2cbe3", "signature": "1b13", "header_sha256": "%s"}\n' \
    "$2" "$(sha256sum <"$1/share/student_weights.h" | cut -d' ' -f1)" >"$1/share/certificate.json"
  echo "unit of $2" >"$1/systemd/bess-edge.service"
  (cd "$1" && sh -c "${3:-true}")
  (cd "$1" && find bin share systemd -type f | sort | xargs sha256sum >SUMS)
  (cd "$1" && sh -c "${4:-true}")
}
machines=0
machine() {  # with 1.0 confirmed and in control
  machines=$((machines + 1))
  BESS_ROOT=$folder/machine$machines
  export BESS_ROOT
  store=$BESS_ROOT/var/lib/bess-edge kept=$BESS_ROOT/var/lib/bess-update
  mkdir -p "$BESS_ROOT/fake" "$BESS_ROOT/etc/bess" "$BESS_ROOT/run/systemd/system" \
    "$store/versions" "$kept" "$BESS_ROOT/usr/lib/systemd/system" \
    "$BESS_ROOT/etc/systemd/system" "$BESS_ROOT/proc/sys/kernel/random"
  printf 'good_cycles = 3  # few\ndeadline_s = 300\npoll_s = 20\n' \
    >"$BESS_ROOT/etc/bess/update.conf"
  printf 'control = true\nmap = "%s/usr/share/bess/maps/alphaess.toml"\n' "$BESS_ROOT" \
    >"$BESS_ROOT/etc/bess/edge.toml"
  echo boot1 >"$BESS_ROOT/proc/sys/kernel/random/boot_id"
  version_into "$store/versions/1.0" 1.0
  ln -s versions/1.0 "$store/current"
  printf '2022-12-31T00:00:00Z\tconfirmed\t1.0\t\n' >"$kept/history"
  cd "$BESS_ROOT/fake" || exit 1
  : >systemctl; echo 1.0 >running; echo active >active; echo 0 >restarts; echo 50 >cycle
  echo 'utc,cycle,mode,price_minute_utc,price_status,battery_status,written' >log.csv
  minute=10
  for _ in 1 2 3; do tick; done
}
tick() {  # two minutes of the running version
  minute=$((minute + 1))
  [ "$(cat active)" = active ] || return 0
  how=$(cat "does_$(cat running)" 2>/dev/null || echo good)
  [ ! -e site ] || how=$(cat site)
  echo $(($(cat cycle) + 1)) >cycle
  case $how in
    crash | hang) return 0 ;;
    silent) row=running,t,ok,ok,0 ;;
    price) row=holding,none,timeout,ok,1 ;;
    trip) row=safe,t,ok,ok,0 ;;
    link) row=safe,t,ok,timeout,0 ;;
    *) row=running,t,ok,ok,1 ;;
  esac
  [ "$how" != late ] || [ "$(cat cycle)" -lt 3 ] || echo failed >active
  echo "2023-01-01T00:$minute:00Z,$(cat cycle),$row" >>log.csv
}
deliver() {  # deliver VERSION [SPOIL BEFORE SUMS] [SPOIL AFTER]: what dpkg unpacks
  rm -rf "$BESS_ROOT/usr/lib/bess-edge"
  version_into "$BESS_ROOT/usr/lib/bess-edge" "$@"
  echo "unit of $1" >"$BESS_ROOT/usr/lib/systemd/system/bess-edge.service"
}
probation() { sh "$script" "$@" >said 2>&1; }
upgrade() { probation admit "$1" && deliver "$@" && probation begin; }
value() { sed -n "s/^$1=//p" "$kept/state"; }
judge() {  # until it has ended, with a maximum number of checks
  looks=0
  while [ $((looks += 1)) -le "${1:-30}" ]; do
    tick
    probation look
    [ -e "$kept/probation" ] || return 0
  done
}
expect() {  # expect WHAT PHASE RUNNING [REASON]
  found="$(value phase) $(cat running) $(value version)"
  [ "$found" = "$2 $3 $3" ] || fail "$1: $found, not $2 $3; $(value reason); $(cat said)"
  case $(value reason) in
    *"${4:-}"*) ;;
    *) fail "$1: the reason is \"$(value reason)\", not $4" ;;
  esac
  printf '%-46s %-12s %-4s %s\n' "$1" "$2" "$3" "$(value reason | cut -c1-70)"
}

printf '%-46s %-12s %-4s %s\n' "package or moment" phase runs reason
machine; upgrade 2.0; judge; expect "a version that works" confirmed 2.0
grep -q '^reload bess-edge' systemctl || fail "a working version gets no hand-over"
grep -q '^stop\|^restart bess-edge' systemctl && fail "a working version is stopped"
[ -d "$store/versions/1.0" ] || fail "the version before is not kept"
upgrade 3.0; judge; expect "and the next one" confirmed 3.0

for does in crash hang silent price trip link late; do
  machine; echo $does >does_2.0
  upgrade 2.0; judge 60; expect "a version that $does" rolled_back 1.0
  grep -q '^stop bess-edge' systemctl || fail "$does: the version that fails is not stopped"
  probation admit 2.0 && fail "$does: it is admitted again"
  [ ! -d "$store/versions/2.0" ] || fail "$does: a blocked version uses space"
  grep -q '2\.0.*1\.0' "$kept/note" || fail "$does: status does not report it"
  grep -q '^bess_update_trouble 1' "$kept/update.prom" || fail "$does: metrics do not report it"
done
machine; upgrade 2.0; judge 1; echo price >site; judge 5; rm site; judge
expect "a market that goes away for ten minutes" confirmed 2.0

refused() {  # refused WHAT [REASON]: the running version continues, and the new one is not blocked
  expect "$1" rolled_back 1.0 "${2:-}"
  grep -qE '^(stop|reload|restart bess-edge|start)' systemctl && fail "$1: running version changed"
  probation admit 2.0 || fail "$1: it is blocked"
}
machine; upgrade 2.0 'echo x >>share/student_weights.h'
refused "a certificate of another header" certificate
machine; upgrade 2.0 "sed -i s/1b13/ffff/ share/certificate.json"
refused "a program that decides otherwise" "signature"
machine; upgrade 2.0 "" "rm share/maps/alphaess.toml"; refused "a file is missing" "alphaess.toml"
machine; upgrade 2.0 "" "echo torn >bin/bess-edge"; refused "a torn program" "bin/bess-edge"
machine; upgrade 2.0 "printf '#!/bin/sh\nexit 139\n' >bin/bess-edge"
refused "a program that does not run"
machine; upgrade 2.0 "sed -i 's/student    ok/student    FAIL/' bin/bess-edge"
refused "a student that fails its self-test" "self-test"
machine; echo unknown_key=1 >>"$BESS_ROOT/etc/bess/edge.toml"; upgrade 2.0
refused "settings that the new version refuses" "unknown key"
[ "$(ls "$BESS_ROOT/etc/bess")" = "edge.toml
update.conf" ] || fail "a file is left next to the settings: $(ls "$BESS_ROOT/etc/bess")"
machine; deliver 1.0 "echo more >>share/maps/alphaess.toml"; probation begin
refused "the same version with other bytes"
machine; upgrade ../x && fail "a version outside of the folder"
machine; upgrade 2.0 "rm share/certificate.json" &&
  fail "no certificate, and dpkg reports success"
[ "$(cat running)" = 1.0 ] || fail "no certificate: $(cat running)"

machine; touch no_room; upgrade 2.0 &&
  fail "a disk without room for the version: dpkg reports success"
grep -q "No space left" said || fail "a disk without room for the version: $(cat said)"
rm no_room; probation begin; judge; expect "a disk that takes it at the second try" confirmed 2.0
machine; echo crash >does_2.0; echo hang >does_3.0; upgrade 2.0; upgrade 3.0; judge 60
expect "two in a row, neither works" rolled_back 1.0
machine; echo crash >does_2.0; upgrade 2.0; judge; probation allow 2.0; rm does_2.0
upgrade 2.0; judge
expect "allowed again, and repaired" confirmed 2.0
machine; upgrade 2.0; judge; upgrade 1.0; judge; expect "a downgrade" confirmed 1.0
machine; upgrade 2.0; judge; probation revert "it trades too much"
expect "back by hand" rolled_back 1.0 "trades too much"
machine; upgrade 2.0; echo inactive >active; for _ in $(seq 18); do probation look; done
[ "$(value phase)" = trying ] || fail "stopped by a person: $(value phase)"
machine; deliver 1.0; echo inactive >active; probation begin
[ "$(cat active) $(cat running)" = "active 1.0" ] ||
  fail "removed, and installed again: it does not run"
machine; upgrade 2.0
echo "unit of 2.0, spoilt" >"$BESS_ROOT/usr/lib/systemd/system/bess-edge.service"
echo crash >does_2.0; judge; expect "a unit that is spoilt" rolled_back 1.0
grep -q "unit of 1.0" "$BESS_ROOT/etc/systemd/system/bess-edge.service" ||
  fail "the version before runs by the new unit"
machine; upgrade 2.0; judge; echo torn >"$store/versions/2.0/bin/bess-edge"; probation boot
systemctl start bess-edge; expect "a card that damages what runs" rolled_back 1.0 "damaged"
machine; echo hang >does_2.0; upgrade 2.0
for n in 2 3 4 5 6 7; do
  echo boot$n >"$BESS_ROOT/proc/sys/kernel/random/boot_id"; probation boot
  systemctl start bess-edge
done
expect "a version that crashes the machine" rolled_back 1.0 "was started"
machine; rm "$store/current"; rm -rf "$store/versions"; upgrade 2.0; judge
expect "the first installation" confirmed 2.0
machine; rm "$store/current"; rm -rf "$store/versions"; echo hang >does_2.0; upgrade 2.0; judge
expect "the first one that hangs" failed 2.0 "no version to go back to"
machine; upgrade 2.0; head -c 20 "$kept/probation" >x; mv x "$kept/probation"; judge
[ "$(cat running)" = 2.0 ] || fail "a damaged state: $(cat running)"

machine; echo crash >does_2.0; upgrade 2.0; ln -sfn versions/1.0 "$store/current"; echo 1.0 >running
probation begin; judge; expect "cut off before the switch, and it crashes" rolled_back 1.0

# Killed at any moment of a delivery, a check and a revert: dpkg or the timer runs again.
cut=0
for does in good crash; do
  for ms in 10 40 120; do
    machine; echo $does >does_2.0
    deliver 2.0
    timeout -s KILL "0.$(printf %03d $ms)" sh "$script" begin >said 2>&1
    probation begin
    for _ in 1 2 3 4 5 6; do
      tick
      timeout -s KILL "0.$(printf %03d $ms)" sh "$script" look >said 2>&1
    done
    probation boot; systemctl start bess-edge; judge 60
    case $does:$(cat running):$(value version) in
      good:2.0:2.0 | crash:1.0:1.0) ;;
      *) fail "killed after $ms ms, the new one is $does: $(cat running) runs; $(value reason)" ;;
    esac
    cut=$((cut + 1))
  done
done
[ $failures -eq 0 ] || { echo "$failures failed, see $folder"; exit 1; }
echo "probation: $machines machines, $cut cuts: each ends with a version that works"
