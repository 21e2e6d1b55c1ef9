#!/bin/sh
# install.sh CMAKE BUILD FOLDER [EMULATOR...]: installs the edge below FOLDER and checks that the
# parts refer to each other: the unit starts the installed program, the example configuration loads
# the installed map.
cmake=$1 build=$2 folder=$3
shift 3
fail() { echo "$*"; exit 1; }
rm -rf "$folder"
DESTDIR=$folder "$cmake" --install "$build" --component edge >/dev/null ||
  fail "cmake --install failed"
unit=$(find "$folder" -name bess-edge.service)
program=$(sed -n 's/^ExecStart=\([^ ]*\) .*/\1/p' "$unit")
[ -x "$folder$program" ] || fail "$unit starts $program, which is not installed"
[ -f "$(find "$folder" -path '*/sysusers.d/bess.conf')" ] || fail "no sysusers file"
config=$folder/etc/bess/edge.toml.example
map=$(sed -n 's/^map = "\(.*\)".*/\1/p' "$config")
[ -f "$folder$map" ] || fail "$config names $map, which is not installed"
grep -q '^folder = "/var/lib/bess"' "$config" || fail "$config keeps its state in the wrong place"
# The installed program reads the installed configuration, with the map in DESTDIR.
sed "s|^map = \"|&$folder|; s|/var/lib/bess|$folder/none|" "$config" >"$folder/edge.toml"
said=$("$@" "$folder$program" status --config "$folder/edge.toml")
[ $? -eq 3 ] || fail "status of a controller that does not run: $said"
