#!/bin/sh
# trial_process.sh BESS_EDGE CUT_AT_LIBRARY FOLDER: the supervisor of upgrades as a process, on
# machines of folders, between stand-ins for systemd, dpkg and the versions' programs. Bad packages
# and bad moments: whatever happens, the version that worked runs, or the new one has shown that it
# works. Prints a table.
edge=$1 cut=$2 folder=${3:?the folder is missing: without it the stand-ins would go into /bin}
script=$(cd "$(dirname "$0")/../../.." && pwd)/edge/update/trial
failures=0
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
  *MainPID*)
    mkdir -p "$BESS_ROOT/proc/7"
    of=$BESS_ROOT/var/lib/bess-edge/versions/$(cat running)
    ln -sfn "$of/bin/bess-edge" "$BESS_ROOT/proc/7/exe"
    echo MainPID=7 ;;
  show*)
    # What crashes is started again and again.
    if [ "$(cat "does_$(cat running)" 2>/dev/null)" = crash ]; then
      echo $(($(cat restarts) + 3)) >restarts
      started
    fi
    echo "ActiveState=$(cat active)"; echo "NRestarts=$(cat restarts)" ;;
  *is-active*) [ "$(cat active)" = active ] ;;
  reload*) echo $(($(cat restarts) + 1)) >restarts; started ;;
  *restart*bess-edge*|start*bess-edge*) started ;;
  stop*) echo inactive >active; : >running ;;
esac
SH
stand_in dpkg-query <<'SH'
#!/bin/sh
cat "$BESS_ROOT/fake/dpkg"
SH
stand_in dpkg <<'SH'
#!/bin/sh
echo "very bad inconsistent state" >&2
exit 1
SH
stand_in cp <<'SH'
#!/bin/sh
[ ! -e "$BESS_ROOT/fake/no_room" ] || { echo "cp: No space left on device" >&2; exit 1; }
exec /bin/cp "$@"
SH
stand_in journalctl <<'SH'
#!/bin/sh
echo "the 'last' error"
SH
export PATH="$folder/bin:$PATH"

# A version's program: it tells what the log has, as the real one does.
version_into() {  # version_into PLACE VERSION [COMMAND in its folder]
  mkdir -p "$1/bin" "$1/share/maps" "$1/systemd"
  cat >"$1/bin/bess-edge" <<SH
#!/bin/sh
case "\$1" in
  signature) echo "student=45d2cbe3 decisions=1 signature=1b13" ;;
  status) for last; do :; done
    ! grep -q unknown_key "\$last" || { echo "bess-edge: \$last:1: unknown key" >&2; exit 1; }
    echo '{"health": "ok"}' ;;
  log) cat "\$BESS_ROOT/fake/log.csv" ;;
esac
SH
  chmod 755 "$1/bin/bess-edge"
  echo "map of $2" >"$1/share/maps/alphaess.toml"
  echo "header of $2" >"$1/share/student_weights.h"
  printf '{"version": "%s", "student": "45d2cbe3", "signature": "1b13", "header_sha256": "%s"}\n' \
    "$2" \
    "$(sha256sum <"$1/share/student_weights.h" | cut -d' ' -f1)" >"$1/share/certificate.json"
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
  store=$BESS_ROOT/var/lib/bess-edge state=$BESS_ROOT/var/lib/bess-update/state
  mkdir -p "$BESS_ROOT/fake" "$BESS_ROOT/etc/bess" "$BESS_ROOT/etc/apt/preferences.d" \
    "$BESS_ROOT/run/systemd/system" \
    "$store/versions" "$BESS_ROOT/var/lib/bess-update" "$BESS_ROOT/usr/lib/systemd/system" \
    "$BESS_ROOT/etc/systemd/system"
  printf 'good_cycles = 3  # few\ndeadline_s = 300\npoll_s = 20\n' \
    >"$BESS_ROOT/etc/bess/update.conf"
  printf 'control = true\nmap = "%s/usr/share/bess/maps/alphaess.toml"\n' "$BESS_ROOT" \
    >"$BESS_ROOT/etc/bess/edge.toml"
  version_into "$store/versions/1.0" 1.0
  ln -s versions/1.0 "$store/current"
  ln -s versions/1.0 "$store/confirmed"
  printf 'phase=confirmed\nversion=1.0\nneeded=3\n' >"$state"
  cd "$BESS_ROOT/fake" || exit 1
  : >systemctl; echo 1.0 >running; echo active >active; echo 0 >restarts; echo 50 >cycle
  echo "ii 1.0" >dpkg
  columns='utc,cycle,mode,price_minute_utc,reason,battery_status,price_status,written,missed_ticks'
  echo "$columns,trip,hold_until_utc" >log.csv
  minute=0
  for _ in 1 2 3; do tick; done
}
tick() {  # two minutes of whatever runs
  minute=$((minute + 1))
  [ "$(cat active)" = active ] || return 0
  how=$(cat "does_$(cat running)" 2>/dev/null || echo good)
  [ ! -e site ] || how=$(cat site)
  echo $(($(cat cycle) + 1)) >cycle
  case $how in
    crash | hang) return 0 ;;
    silent) row=running,t,price_low,ok,ok,0,0,none,none ;;
    price) row=holding,none,no_price,ok,timeout,1,0,none,none ;;
    trip) row=safe,t,wrong_direction,ok,ok,0,0,wrong_direction,none ;;
    link) row=safe,t,link,timeout,ok,0,0,none,none ;;
    every_second) [ $((minute % 2)) = 0 ] && row=running,t,student,ok,ok,1,0,none,none ||
      row=safe,t,link,timeout,ok,0,0,none,none ;;
    *) row=running,t,student,ok,ok,1,0,none,none ;;
  esac
  echo "2023-01-01T00:$minute:00Z,$(cat cycle),$row" >>log.csv
}
deliver() {  # deliver VERSION [SPOIL BEFORE SUMS] [SPOIL AFTER]: what dpkg unpacks
  rm -rf "$BESS_ROOT/usr/lib/bess-edge"
  version_into "$BESS_ROOT/usr/lib/bess-edge" "$1" "${2:-}" "${3:-}"
  echo "unit of $1" >"$BESS_ROOT/usr/lib/systemd/system/bess-edge.service"
  echo "ii $1" >dpkg
}
trial() { "$edge" trial "$@" >said 2>&1; }
upgrade() { trial announce "$1" && deliver "$@" && trial begin; }
value() { sed -n "s/^$1=//p" "$state"; }
judge() {  # until the phase stands, at most so many looks
  looks=0
  while [ $((looks += 1)) -le "${1:-30}" ]; do
    tick
    trial look
    case $(value phase) in confirmed | rolled_back | failed) return 0 ;; esac
  done
}
expect() {  # expect WHAT PHASE RUNNING [REASON]
  found="$(value phase) $(cat running) $(basename "$(readlink "$store/current")")"
  [ "$found" = "$2 $3 $3" ] || fail "$1: $found, not $2 $3; $(value reason); $(cat said)"
  case $(value reason) in
    *"${4:-}"*) ;;
    *) fail "$1: the reason is \"$(value reason)\", not $4" ;;
  esac
  printf '%-46s %-12s %-4s %s\n' "$1" "$2" "$3" "$(value reason | cut -c1-70)"
}

printf '%-46s %-12s %-4s %s\n' "package or moment" phase runs reason
machine; upgrade 2.0; judge; expect "a version that works" confirmed 2.0
grep -q '^reload bess-edge' systemctl || fail "a version that works is not handed over to"
grep -q '^stop\|^restart bess-edge' systemctl && fail "a version that works is stopped"
[ "$(readlink "$store/confirmed")" = versions/2.0 ] || fail "the confirmed version does not judge"
[ -d "$store/versions/1.0" ] || fail "the version before is not kept"
deliver 3.0; trial announce 3.0; trial begin; judge
[ ! -d "$store/versions/1.0" ] || fail "three versions are kept"

for does in crash hang silent every_second price trip link; do
  machine; echo $does >does_2.0
  upgrade 2.0; judge 60; expect "a version that $does" rolled_back 1.0
  grep -q '^stop bess-edge' systemctl || fail "$does: the version that fails is not stopped"
  grep -q '^Pin: version 2.0$' "$BESS_ROOT/etc/apt/preferences.d/bess-edge-rolled-back.pref" ||
    fail "$does: apt may bring it again"
  trial announce 2.0 && fail "$does: it is let in again"
  [ ! -d "$store/versions/2.0" ] || fail "$does: a refused version takes room"
  grep -q "^delivered=ii 2.0$" "$state" || fail "$does: what dpkg has is not told"
  trial dismiss || fail "$does: a dismissal: $(cat said)"
  [ -s "$BESS_ROOT/etc/apt/preferences.d/bess-edge-rolled-back.pref" ] ||
    fail "$does: a dismissal lets apt bring it"
done
machine; echo price >site; tick; upgrade 2.0; judge 8
[ "$(value phase)" = trying ] || fail "a market that is away: $(value phase) $(value reason)"
rm site; judge; expect "a market that was away before" confirmed 2.0
machine; upgrade 2.0; judge 1; echo price >site; judge 9
[ "$(cat running)" = 2.0 ] ||
  fail "a market that goes away in the trial: $(cat running) runs, $(value phase)"
rm site; judge; expect "a market that goes away in the trial" confirmed 2.0
grep -q '	comparing	2.0	' "$BESS_ROOT/var/lib/bess-update/history" ||
  fail "the version before was not asked"
machine; upgrade 2.0; judge 1; echo price >site; judge 6
[ "$(value phase)" = comparing ] || fail "a market that is away for six cycles: $(value phase)"
tick; rm site; judge; expect "a market that comes back while one compares" confirmed 2.0
machine; echo trip >site; tick; upgrade 2.0; judge 30
[ "$(value phase)" = trying ] || fail "a trip from before: $(value phase)"
rm site; judge; expect "a trip from before" confirmed 2.0

refused() {  # refused WHAT REASON: the version that ran runs on, untouched
  expect "$1" rolled_back 1.0 "$2"
  grep -qE '^(stop|reload|restart bess-edge|start)' systemctl && fail "$1: what runs was touched"
}
machine; upgrade 2.0 'echo x >>share/student_weights.h'
refused "a certificate of another header" "another header"
machine; upgrade 2.0 "sed -i s/1b13/ffff/ share/certificate.json"
refused "a program that decides otherwise" "signature 1b13"
machine; upgrade 2.0 "" "rm share/maps/alphaess.toml"; refused "a file is missing" "alphaess.toml"
machine; upgrade 2.0 "" "echo torn >bin/bess-edge"; refused "a torn program" "bin/bess-edge"
machine; upgrade 2.0 "printf '#!/bin/sh\nexit 139\n' >bin/bess-edge"
refused "a program that does not run" "does not run"
machine; upgrade 2.0 "rm share/certificate.json"; refused "no certificate" "certificate"
machine; echo unknown_key=1 >>"$BESS_ROOT/etc/bess/edge.toml"; upgrade 2.0
refused "settings that the new version refuses" "refuses this machine's settings"
[ "$(ls "$BESS_ROOT/etc/bess")" = "edge.toml
update.conf" ] || fail "something is left beside the settings: $(ls "$BESS_ROOT/etc/bess")"
machine; trial announce 1.0; deliver 1.0 "echo more >>share/maps/alphaess.toml"; trial begin
refused "the same version with other bytes" "other bytes"
machine; upgrade ../x; refused "a version that leads out of the folder" "no version"

machine; trial announce 2.0
for _ in $(seq 31); do trial look; done
expect "dpkg that does not end" rolled_back 1.0 "dpkg did not end"
may_come() {  # may_come WHAT: 2.0 was never judged: apt may bring it, and it gets in
  [ ! -s "$BESS_ROOT/etc/apt/preferences.d/bess-edge-rolled-back.pref" ] ||
    fail "$1: a version that was never judged is pinned"
  upgrade 2.0; judge; expect "$1, and then does" confirmed 2.0
}
may_come "dpkg that does not end"
gives_up() {  # gives_up WHAT PHASE: dpkg calls the scripts' abort-upgrade
  trial withdraw 2.0 || fail "$1: $(cat said)"
  expect "$1" "$2" 1.0
  grep -qE '^(stop|reload|restart bess-edge|start)' systemctl && fail "$1: what runs was touched"
}
machine; trial announce 2.0; gives_up "dpkg that gives up" confirmed; may_come "dpkg that gave up"
grep -q '	withdrawn	2.0	' "$BESS_ROOT/var/lib/bess-update/history" ||
  fail "the history does not tell what dpkg gave up"
machine; trial announce 2.0; for _ in $(seq 31); do trial look; done
gives_up "dpkg that gives up late" confirmed; may_come "dpkg that gave up late"
machine; trial announce 2.0; for _ in $(seq 31); do trial look; done
trial announce 1.0; deliver 1.0; trial begin; trial announce 3.0; trial withdraw 3.0
expect "dpkg gives up, what it broke before is mended" confirmed 1.0
machine; trial announce 2.0; trial withdraw 1.9; [ "$(value phase)" = upgrading ] ||
  fail "another version is withdrawn: $(value phase)"
machine; echo crash >does_2.0; upgrade 2.0; judge; trial announce 3.0; : >systemctl
trial withdraw 3.0
expect "dpkg gives up after a roll-back" rolled_back 1.0 "last"
trial announce 2.0 && fail "what was rolled back is let in by another's withdrawal"
trial withdraw 2.0; trial announce 2.0 &&
  fail "what was rolled back is let in by its own withdrawal"
machine; upgrade 2.0; trial announce 3.0; trial withdraw 3.0; judge
expect "dpkg gives up in a trial" confirmed 2.0
machine; touch no_room; upgrade 2.0 &&
  fail "a disk that does not take the version: dpkg is told that all is well"
grep -q "2.0 cannot be kept: cp: No space left" said ||
  fail "a disk that does not take the version: $(cat said)"
[ "$(value phase) $(cat running)" = "upgrading 1.0" ] ||
  fail "a disk that does not take the version: $(value phase)"
rm no_room; trial begin; judge; expect "a disk that takes it at the second try" confirmed 2.0
# What dpkg has when its scripts run is not what it has when it ends: the supervisor looks until it
# has.
machine; printf 'poll_s = 1\nupgrade_s = 60\n' >"$BESS_ROOT/etc/bess/update.conf"
echo iHR1.0 >dpkg; trial announce 2.0; trial withdraw 2.0; [ "$(value delivered)" = iHR1.0 ] ||
  fail "dpkg's half work: $(value delivered)"
(sleep 2; echo "ii 1.0" >dpkg) &
timeout 50 "$edge" trial supervise >said 2>&1 || fail "after dpkg has ended, the supervisor has not"
[ "$(value delivered)" = "ii 1.0" ] || fail "what dpkg has in the end: $(value delivered)"
# A delivery that is killed around the flip: what has confirmed itself hands its order over, and
# what was handed over to already is left alone.
flipped=0 late=0 n=10
while [ $((n += 1)) -le 16 ]; do
  machine; trial announce 2.0; deliver 2.0
  BESS_CUT_AT=$n BESS_CUT_KIND=kill LD_PRELOAD=$cut "$edge" trial begin >said 2>&1
  case "$(value handed_over) $(readlink "$store/current") $(cat running)" in
    "0 versions/2.0 1.0") flipped=1 ;;
    "0 versions/2.0 2.0") late=1 ;;
  esac
  judge; expect "the delivery is killed at its write $n" confirmed 2.0
  grep -q '^stop' systemctl && fail "killed at $n: the order from before is ended"
  [ "$(grep -c '^reload bess' systemctl)" = 1 ] || fail "killed at $n: not one hand-over"
done
[ $flipped$late = 11 ] || fail "none was killed behind the flip: $flipped, $late"
machine; echo hang >does_2.0; upgrade 2.0; judge 8
[ "$(value phase) $(value bad_cause)" = "comparing no_cycle" ] ||
  fail "a version without a cycle in 160 s: $(value phase), $(value bad_cause)"
: >systemctl; judge 1
[ "$(value phase)" = trying ] || fail "the first time it is chance: $(value phase)"
grep -q '^stop' systemctl && fail "after the comparison the order is ended"
judge; expect "hangs a second time" rolled_back 1.0 "it has no cycle"
machine; trial announce 2.0; trial recover; [ "$(value phase)" = confirmed ] ||
  fail "a cut in dpkg: $(value phase)"
upgrade 2.0; judge; expect "the power cut while dpkg unpacks" confirmed 2.0
machine; echo crash >does_2.0; echo hang >does_3.0
upgrade 2.0; upgrade 3.0; judge; expect "two in a row, neither works" rolled_back 1.0
trial announce 2.0 || fail "a version that was never judged is refused"
machine; echo every_second >does_2.0; echo every_second >does_3.0
upgrade 2.0; judge 5; upgrade 3.0; judge 60
expect "two in a row that lose every second" rolled_back 1.0
machine; echo every_second >does_2.0; echo every_second >does_3.0
upgrade 2.0; judge 60; upgrade 3.0; judge 60
expect "one that does after one that did" rolled_back 1.0
machine; echo crash >does_3.0
upgrade 2.0 "sed -i 's/log) cat/log) exit 1; cat/' bin/bess-edge"; upgrade 3.0; judge
expect "the first of two cannot tell" rolled_back 1.0
machine; echo crash >does_2.0; echo crash >does_3.0
upgrade 2.0; judge; upgrade 3.0; judge; expect "two that are rolled back" rolled_back 1.0
for version in 2.0 3.0; do trial announce $version &&
  fail "$version is let in again after two"; done
trial allow 2.0; rm does_2.0; upgrade 2.0; judge; expect "allowed again, and mended" confirmed 2.0
machine; upgrade 2.0; judge; upgrade 1.0; judge; expect "a downgrade" confirmed 1.0
machine; upgrade 2.0; judge; trial go-back "it trades too much"
expect "back by hand" rolled_back 1.0 "trades too much"
machine; upgrade 2.0; echo inactive >active
for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18; do trial look; done
[ "$(value phase)" = trying ] || fail "stopped by a person: $(value phase)"
machine; trial announce 1.0; deliver 1.0; echo inactive >active; trial begin
expect "removed, and installed again" confirmed 1.0
[ "$(cat active)" = active ] || fail "removed, and installed again: the controller does not run"
machine; upgrade 2.0 "" ""
echo "unit of 2.0, spoilt" >"$BESS_ROOT/usr/lib/systemd/system/bess-edge.service"
echo crash >does_2.0; judge; expect "a unit that is spoilt" rolled_back 1.0
grep -q "unit of 1.0" "$BESS_ROOT/etc/systemd/system/bess-edge.service" ||
  fail "the version before runs by the new unit"
machine; upgrade 2.0; judge; echo torn >"$store/versions/2.0/bin/bess-edge"; echo 1.0 >running
trial recover
expect "a card that damages what runs" rolled_back 1.0 "damaged"
# As the service runs it: looks of a second each, and time that is not on the disk at each of them.
short() {
  sed -i "s/^poll_s.*/poll_s = 1/; s/^deadline_s.*/deadline_s = 4\nupgrade_s = 4/" \
    "$BESS_ROOT/etc/bess/update.conf"
}
machine; short; echo hang >does_2.0; upgrade 2.0; timeout 60 "$edge" trial supervise >said 2>&1
expect "a service that hangs, by the clock" rolled_back 1.0 "0 of 3 good cycles in"
machine; short; trial announce 2.0; timeout 60 "$edge" trial supervise >said 2>&1
expect "dpkg that does not end, by the clock" rolled_back 1.0 "dpkg did not end"
machine; short; echo hang >does_2.0; upgrade 2.0; : >systemctl
BESS_CUT_AT=1 BESS_CUT_KIND=full LD_PRELOAD=$cut timeout 10 "$edge" trial supervise >said 2>&1
[ $? = 124 ] || fail "a disk that takes nothing: the supervisor has ended: $(cat said)"
grep -q '^stop' systemctl && fail "a disk that takes nothing: what runs is stopped"
grep -q "good cycles in" said || fail "a disk that takes nothing: the deadline does not count"
timeout 60 "$edge" trial supervise >said 2>&1
expect "a disk that takes nothing for a while" rolled_back 1.0
old_state() {
  printf 'phase=%s\nversion=1.0\nprevious=0.9\nneeded=3\n' "$1" >"$state"; : >systemctl
}
for phase in trying going_back; do
  machine; old_state $phase; trial look; trial look
  [ "$(readlink "$store/current") $(cat running)" = "versions/1.0 1.0" ] ||
    fail "$phase, to a version that is not kept: $(readlink "$store/current")"
  grep -q '^stop' systemctl && fail "$phase, to a version that is not kept: what runs is stopped"
done
# The power between the decision and the start: the cycles in the log are not those of the version
# that is started.
machine; echo crash >does_2.0; upgrade 2.0; rm "$state.copy"
sed -i '/^# crc32/d; s/^mark=.*/mark=/; s/^handed_over=.*/handed_over=0/; s/^fresh=.*/fresh=0/' \
  "$state"
trial recover; judge; expect "the power before a version is started" rolled_back 1.0
moved_script() { sed "s|/var/lib|$BESS_ROOT&|g; s|/usr/|$BESS_ROOT&|g" "$script" >x; }
machine; rm "$store/current" "$store/confirmed"; moved_script
sh x announce 2.0 2>said || fail "where nothing can judge, nothing can be installed: $(cat said)"
sh x begin 2>said && fail "where nothing can judge, a version is let in"
machine; moved_script; mkdir "$BESS_ROOT/usr/bin"
ln -s "$store/current/bin/bess-edge" "$BESS_ROOT/usr/bin/"
echo "iUR2.0" >dpkg; sh x recover >said 2>&1
cmp -s "$BESS_ROOT/usr/share/bess/maps/alphaess.toml" \
  "$store/versions/1.0/share/maps/alphaess.toml" ||
  fail "cut in the first upgrade of an old package: its maps are gone: $(cat said)"
machine; upgrade 2.0; head -c 40 "$state" >x; mv x "$state"; judge
expect "a damaged state" confirmed 2.0
for file in state state.copy history; do
  machine; upgrade 2.0; rm "$BESS_ROOT/var/lib/bess-update/$file"
  mkdir "$BESS_ROOT/var/lib/bess-update/$file"
  judge; expect "a folder in place of $file" confirmed 2.0
  grep -q confirmed "$BESS_ROOT/var/lib/bess-update/history" ||
    fail "a folder in place of $file: no history"
done
machine; upgrade 2.0; : >"$state"; : >"$state.copy"; trial look
[ "$(value phase) $(cat running)" = "failed 2.0" ] ||
  fail "both states damaged: $(value phase) $(cat running)"

# The power at every step, and a disk that is full from every step on.
ends() {
  case "$(value phase):$(cat running):$(basename "$(readlink "$store/current")"):$1" in
    confirmed:1.0:1.0:* | confirmed:2.0:2.0:good | rolled_back:1.0:1.0:*) ;;
    *)
      fail "$2: $(value phase), $(cat running) runs," \
        "$(readlink "$store/current"); $(value reason)" ;;
  esac
}
steps=0
for does in good crash; do
  for kind in kill full; do
    for where in announce begin look; do
      n=0
      while [ $((n += 1)) -le "${BESS_CUTS:-3}" ]; do
        machine
        echo $does >does_2.0
        cut_now() {
          BESS_CUT_AT=$n BESS_CUT_KIND=$kind LD_PRELOAD=$cut "$edge" trial "$@" >said 2>&1
        }
        if [ $where = announce ]; then cut_now announce 2.0; else trial announce 2.0; fi
        if [ $? = 0 ] || [ $kind = kill ]; then
          deliver 2.0
          if [ $where = begin ]; then cut_now begin; else trial begin; fi
          if [ $where = look ]; then for _ in 1 2 3; do tick; cut_now look; done; fi
        fi
        if [ $kind = kill ]; then  # and a boot
          trial recover
          echo inactive >active; systemctl start bess-edge
        fi
        trial begin; judge
        ends $does "$kind at $n in $where, the new version is $does"
        steps=$((steps + 1))
      done
    done
  done
done
[ $failures -eq 0 ] || { echo "$failures failed, see $folder"; exit 1; }
echo "trial: $machines machines, $steps cuts and full disks: each ends with a version that works"
