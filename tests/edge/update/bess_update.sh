#!/bin/sh
# bess_update.sh SCRIPT FOLDER: the supervisor of upgrades between stand-ins for dpkg, systemd and the controller:
# when it confirms, when it goes back, and that a power cut at any of its writes leaves one working version.
script=$1 folder=$2
failures=0
rm -rf "$folder"
mkdir -p "$folder/bin"
fail() { echo "FAILED: $*"; failures=$((failures + 1)); }

stand_in() { cat >"$folder/bin/$1" && chmod 755 "$folder/bin/$1"; }
# A package is a file that holds its version; what is installed is $BESS_ROOT/fake/{status,version}.
stand_in dpkg-query <<'SH'
#!/bin/sh
case "$3" in *Abbrev*) cat "$BESS_ROOT/fake/status" ;; *) cat "$BESS_ROOT/fake/version" ;; esac
SH
stand_in dpkg-repack <<'SH'
#!/bin/sh
[ ! -e "$BESS_ROOT/fake/full" ] || { echo "No space left on device" >&2; exit 1; }
cp "$BESS_ROOT/fake/version" bess-edge_x.deb
SH
stand_in dpkg-deb <<'SH'
#!/bin/sh
cat "$2"
SH
stand_in dpkg <<'SH'
#!/bin/sh
[ -n "$BESS_UPDATE_LOCKED" ] || exit 9
[ ! -e "$BESS_ROOT/fake/dpkg_fails" ] || { rm "$BESS_ROOT/fake/dpkg_fails"; echo "dpkg: error: locked"; exit 2; }
for last; do :; done
case "$last" in
  *.deb)
    printf 'iHR' >"$BESS_ROOT/fake/status"
    [ ! -e "$BESS_ROOT/fake/cut_in_dpkg" ] || { rm "$BESS_ROOT/fake/cut_in_dpkg"; kill -9 $PPID; exit 1; }
    cp "$last" "$BESS_ROOT/fake/version" ;;
  *) [ "$(cat "$BESS_ROOT/fake/status")" = "iF " ] || exit 1 ;;  # --configure
esac
printf 'ii ' >"$BESS_ROOT/fake/status"
"$SCRIPT" begin
SH
stand_in systemctl <<'SH'
#!/bin/sh
echo "$*" >>"$BESS_ROOT/fake/systemctl"
case "$*" in
  *ActiveState*) cat "$BESS_ROOT/fake/active" ;;
  *MainPID*) echo 7 ;;
  *NRestarts*)
    n=$(cat "$BESS_ROOT/fake/restarts")
    echo "$n"
    [ "$(cat "$BESS_ROOT/fake/version")" != "$(cat "$BESS_ROOT/fake/crashes" 2>/dev/null)" ] || echo $((n + 1)) >"$BESS_ROOT/fake/restarts" ;;
esac
SH
stand_in bess-edge <<'SH'
#!/bin/sh
version=$(cat "$BESS_ROOT/fake/version")
[ "$version" != "$(cat "$BESS_ROOT/fake/crashes" 2>/dev/null)" ] || exit 139
n=$(cat "$BESS_ROOT/fake/cycles")
[ "$version" = "$(cat "$BESS_ROOT/fake/hangs" 2>/dev/null)" ] || n=$((n + 1))
echo "$n" >"$BESS_ROOT/fake/cycles"
mode=running
[ "$version" != "$(cat "$BESS_ROOT/fake/safe" 2>/dev/null)" ] || mode=safe
printf '{\n\t"control":\ttrue,\n\t"pid":\t7,\n\t"last":\t{\n\t\t"mode":\t"%s",\n\t\t"has_price":\ttrue,\n' "$mode"
printf '\t\t"price_status":\t"ok",\n\t\t"battery_status":\t"ok",\n\t\t"written":\ttrue\n\t},\n'
printf '\t"totals":\t{\n\t\t"cycles":\t%s\n\t}\n}\n' "$n"
SH
stand_in journalctl <<'SH'
#!/bin/sh
echo 'the "last" error	line'
SH
stand_in sleep <<'SH'
#!/bin/sh
read -r now <"$BESS_ROOT/proc/uptime"
echo $((${now%.*} + 10)).00 >"$BESS_ROOT/proc/uptime"
SH
# The power fails at the n-th write that is waited for.
stand_in sync <<'SH'
#!/bin/sh
[ -e "$BESS_ROOT/fake/cut_at" ] || exit 0
n=$(($(cat "$BESS_ROOT/fake/cut_at") - 1))
echo "$n" >"$BESS_ROOT/fake/cut_at"
[ "$n" -gt 0 ] || { rm "$BESS_ROOT/fake/cut_at"; kill -9 $PPID; }
SH
export PATH="$folder/bin:$PATH" SCRIPT="$script"

case_number=0
machine() {  # a machine with version 1.0 confirmed
  case_number=$((case_number + 1))
  BESS_ROOT=$folder/machine$case_number
  export BESS_ROOT
  mkdir -p "$BESS_ROOT/fake" "$BESS_ROOT/etc/bess" "$BESS_ROOT/etc/apt/preferences.d" "$BESS_ROOT/usr/share/bess"
  printf 'good_cycles = 3   # few\ndeadline_s = 300\n' >"$BESS_ROOT/etc/bess/update.conf"
  printf '{\n "student": "45d2cbe3",\n "header_sha256": "72c9"\n}\n' >"$BESS_ROOT/usr/share/bess/certificate.json"
  mkdir -p "$BESS_ROOT/var/lib/bess-update" "$BESS_ROOT/proc"
  echo 100.00 >"$BESS_ROOT/proc/uptime"
  echo header >"$BESS_ROOT/var/lib/bess-update/confirmed_student_weights.h"
  echo 1.0 >"$BESS_ROOT/var/lib/bess-update/confirmed.deb"
  echo new_header >"$BESS_ROOT/usr/share/bess/student_weights.h"
  cd "$BESS_ROOT/fake" || exit 1
  printf 'ii ' >status
  echo 1.0 >version
  echo active >active
  echo 0 >restarts
  echo 0 >cycles
}
upgrade() {  # upgrade VERSION: what dpkg and the maintainer scripts do
  "$SCRIPT" keep || return 1
  printf 'iHR' >"$BESS_ROOT/fake/status"
  echo "$1" >"$BESS_ROOT/fake/version"
  printf 'iF ' >"$BESS_ROOT/fake/status"
  printf 'ii ' >"$BESS_ROOT/fake/status"
  "$SCRIPT" begin
}
value() { sed -n "s/^$1=//p" "$BESS_ROOT/var/lib/bess-update/state" 2>/dev/null; }
expect() {  # expect KEY VALUE WHAT
  [ "$(value "$1")" = "$2" ] || fail "$3: $1 is \"$(value "$1")\", not \"$2\""
}
expect_version() { [ "$(cat "$BESS_ROOT/fake/version")" = "$1" ] || fail "$2: $(cat "$BESS_ROOT/fake/version") is installed, not $1"; }
run() { "$SCRIPT" "$@" >"$BESS_ROOT/fake/said" 2>&1; }

machine
upgrade 2.0 || fail "an upgrade that works"
expect phase trying "after the installation"
run supervise
expect phase confirmed "three good cycles"
expect good 3 "three good cycles"
[ "$(cat "$BESS_ROOT/var/lib/bess-update/previous.deb")" = 1.0 ] || fail "the package before is not kept"
[ "$(cat "$BESS_ROOT/var/lib/bess-update/confirmed.deb")" = 2.0 ] || fail "the confirmed package is not kept"
[ "$(cat "$BESS_ROOT/var/lib/bess-update/previous_student_weights.h")" = header ] || fail "the header before is not kept"
cut -f2,3,4,5 "$BESS_ROOT/var/lib/bess-update/history" | tr '\t\n' ' ;' >said
[ "$(cat said)" = "trying 2.0 45d2cbe3 72c9;confirmed 2.0 45d2cbe3 72c9;" ] || fail "history: $(cat said)"
! grep -q restart systemctl || fail "a version that confirms itself was restarted"

for trouble in crashes hangs safe; do
  machine
  upgrade 2.0
  echo 2.0 >$trouble
  run supervise
  expect phase rolled_back "a version that $trouble"
  expect refused 2.0 "a version that $trouble"
  expect_version 1.0 "a version that $trouble"
  grep -q '^restart --no-block bess-edge.service' systemctl || fail "$trouble: the version before is not started"
  grep -q '^Pin: version 2.0$' "$BESS_ROOT/etc/apt/preferences.d/bess-edge-rolled-back.pref" || fail "$trouble: apt may bring it again"
  grep -q "the 'last' error line" "$BESS_ROOT/var/lib/bess-update/state" || fail "$trouble: the reason misses the last error: $(value reason)"
  grep -q 'bess_update_rolled_back{version="2.0"' "$BESS_ROOT/var/lib/bess-update/update.prom" || fail "$trouble: not in the metrics"
done

machine
upgrade 2.0
echo failed >active
echo 2.0 >crashes
run supervise
expect phase rolled_back "a unit that failed"

machine
upgrade 2.0
echo 2.0 >crashes
touch dpkg_fails
run supervise
expect phase rolled_back "dpkg was busy at the first attempt"
expect_version 1.0 "dpkg was busy at the first attempt"
run dismiss || fail "a dismissal: $(cat said)"
expect phase confirmed "a dismissal"
! grep -q rolled_back "$BESS_ROOT/var/lib/bess-update/update.prom" || fail "the metrics tell of what was dismissed"
[ -e "$BESS_ROOT/etc/apt/preferences.d/bess-edge-rolled-back.pref" ] || fail "apt may bring again what was dismissed"
! run dismiss || fail "dismissed twice"

# The version after one that failed: its way back is the version that works, and it may confirm.
upgrade 3.0
expect previous 1.0 "after a roll-back"
rm crashes
echo active >active
run supervise
expect phase confirmed "the version after one that failed"
expect refused "" "the version after one that failed"
[ ! -e "$BESS_ROOT/etc/apt/preferences.d/bess-edge-rolled-back.pref" ] || fail "the pin stays after a confirmation"

# A second upgrade before the first has confirmed: back to what last worked.
machine
upgrade 2.0
upgrade 3.0
echo 3.0 >crashes
run supervise
expect_version 1.0 "two upgrades, none confirmed"

machine
rm -f "$BESS_ROOT/var/lib/bess-update/confirmed.deb"
"$SCRIPT" begin
echo 1.0 >crashes
run supervise
expect phase failed "a first installation that does not work"
grep -q 'bess_update_failed{version="1.0"' "$BESS_ROOT/var/lib/bess-update/update.prom" || fail "a failure is not in the metrics"
expect_version 1.0 "a first installation that does not work"

machine
touch full
upgrade 2.0
run supervise
expect phase confirmed "a full disk"
grep -q "2.0 cannot be kept for the next upgrade to come back to: No space left on device" said || fail "full disk: $(cat said)"
upgrade 3.0
expect previous 1.0 "a full disk, then another upgrade"

machine
upgrade 2.0
run go-back "" && fail "go-back without a reason"
run go-back "it trades too much"
expect reason "it trades too much" "by hand"
expect_version 1.0 "by hand"

# Power cuts: at the n-th durable write of keep, begin, or supervise; inside dpkg; and then a boot.
for trouble in none crashes; do
  for step in keep begin supervise; do
    case $step in keep) writes=7 ;; begin) writes=7 ;; supervise) writes=20 ;; esac
    n=0
    while [ $((n += 1)) -le $writes ]; do
      machine
      [ $trouble = none ] || echo 2.0 >$trouble
      [ $step != keep ] || echo $n >cut_at
      if "$SCRIPT" keep >/dev/null 2>&1; then
        echo 2.0 >version
        printf 'iF ' >status
        [ $step != begin ] || echo $n >cut_at
        if (printf 'ii ' >status; "$SCRIPT" begin) >/dev/null 2>&1; then
          [ $step != supervise ] || echo $n >cut_at
          run supervise
        elif [ $step = begin ]; then
          printf 'iF ' >status  # dpkg has not seen the end of postinst
        fi
      fi 2>/dev/null
      rm -f cut_at
      run recover || fail "cut $n in $step ($trouble): recover: $(cat said)"
      run supervise
      what="power cut $n in $step, the new version $trouble"
      [ "$(cat status)" = "ii " ] || fail "$what: dpkg says $(cat status)"
      case "$(value phase):$(cat version):$trouble" in
        :1.0:* | confirmed:1.0:* | confirmed:2.0:none | rolled_back:1.0:crashes) ;;
        *) fail "$what: ends as $(value phase) with $(cat version)" ;;
      esac
    done
  done
done
machine
upgrade 2.0
echo 2.0 >crashes
touch cut_in_dpkg
run supervise
[ "$(cat status)" = iHR ] || fail "the stand-in did not break off inside dpkg"
run recover
expect phase rolled_back "power cut inside dpkg"
expect_version 1.0 "power cut inside dpkg"
machine
"$SCRIPT" keep
printf 'iHR' >status  # cut while the new version was unpacked
echo 2.0 >version
run recover
expect_version 1.0 "power cut while unpacking"
[ "$(cat status)" = "ii " ] || fail "power cut while unpacking: dpkg says $(cat status)"

# A card that forgets: one of the two files costs nothing, both leave the version that runs, and a line.
damage() {  # damage KIND FILE
  case $1 in
    flip) sed -i 's/good=1/good=3/; s/phase=trying/phase=tryinG/' "$2" ;;
    cut) head -c 40 "$2" >"$2.cut" && mv "$2.cut" "$2" ;;
    empty) : >"$2" ;;
    zeros) head -c 200 /dev/zero >"$2" ;;
    gone) rm "$2" ;;
    folder) rm "$2" && mkdir "$2" ;;
  esac
}
for one in flip:state cut:state zeros:state gone:state flip:state.copy flip:both empty:both folder:state folder:state.copy folder:both; do
  kind=${one%:*} files=${one#*:}
  machine
  upgrade 2.0
  state=$BESS_ROOT/var/lib/bess-update/state
  cmp -s "$state" "$state.copy" || fail "the copy differs"
  [ $files = state.copy ] || damage "$kind" "$state"
  [ $files = state ] || damage "$kind" "$state.copy"
  run supervise
  case $files:$kind in
    both:*)
      expect phase failed "$one"
      expect version 2.0 "$one"
      grep -q "is lost: .* and its copy are damaged" said || fail "$one: no line: $(cat said)" ;;
    state:*)
      expect phase confirmed "$one"
      grep -q "state is damaged: its copy counts" said || fail "$one: no line: $(cat said)" ;;
    *) expect phase confirmed "$one" ;;
  esac
  expect_version 2.0 "$one"
  cmp -s "$state" "$state.copy" || fail "$one: not mended"
  [ "$kind" != folder ] || grep -q "is a folder: it is set aside as" said || fail "$one: no line: $(cat said)"
done
machine
upgrade 2.0
rm "$BESS_ROOT/var/lib/bess-update/history"
mkdir "$BESS_ROOT/var/lib/bess-update/history"
run supervise
expect phase confirmed "a folder in place of the history"
grep -q confirmed "$BESS_ROOT/var/lib/bess-update/history" || fail "a folder in place of the history: none is kept"
# The script of the version before writes neither checksum nor copy: its word is the newer one.
machine
upgrade 2.0
state=$BESS_ROOT/var/lib/bess-update/state
sed '/^#/d; s/phase=trying/phase=confirmed/' "$state" >older && mv older "$state"
run supervise
expect phase confirmed "written by an older version"
[ "$(cat cycles)" = 0 ] || fail "a trial that an older version has ended goes on"

[ $failures -eq 0 ] || { echo "$failures failed, see $folder"; exit 1; }
echo "bess-update: $case_number machines, each with one working version"
