#!/bin/sh
# systemd_unit.sh UNIT FOLDER: the unit has no unknown or misspelt setting and its exposure, as
# systemd itself rates it, is at most 2.0 of 10. FOLDER takes a copy whose program exists. Exit 77 =
# skipped.
unit=$1 folder=$2
command -v systemd-analyze >/dev/null || { echo "systemd-analyze is not installed"; exit 77; }
systemd-analyze security --offline=yes --threshold=20 "$unit" | tail -n 1
systemd-analyze security --offline=yes --threshold=20 "$unit" >/dev/null || {
  echo "exposure above 2.0: systemd-analyze security --offline=yes $unit"
  exit 1
}
mkdir -p "$folder"
copy=$folder/$(basename "$unit")
sed 's|^ExecStart=/usr/bin/bess-[a-z]*|ExecStart=/bin/true|
     s|^User=.*|User=root|; s|^Group=.*|Group=root|' "$unit" >"$copy"
complaints=$(systemd-analyze verify --man=no "$copy" 2>&1 | grep -F "$(basename "$unit")")
[ -z "$complaints" ] || { echo "$complaints"; exit 1; }
