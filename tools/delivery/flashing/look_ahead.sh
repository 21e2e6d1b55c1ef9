# Sent to a machine by tools/flash ssh, before anything is installed there: what the new program
# makes of this machine's settings.
#   sh look_ahead.sh PACKAGE SETTINGS MAPS [SUDO]
# Exit codes: 0 go on, 1 the settings are refused.
package=$1 settings=$2 maps=$3 as_root=${4:-}
# Without settings, or the maps that they name, there is nothing to look at yet.
[ -e "$settings" ] && [ -d "$maps" ] || exit 0
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
dpkg-deb -x "$package" "$work" && chmod 755 "$work"
edge=$work/usr/lib/bess-edge/bin/bess-edge
"$edge" --version >/dev/null 2>&1 || exit 0   # its libraries come with the installation
if systemctl is-active --quiet bess-edge; then
  # While a controller holds the battery, that is all it can look at. That it answers is what
  # counts: its exit code tells of the controller, and on stderr others speak as well.
  status=$($as_root "$edge" status --config "$settings" --json --no-lock 2>"$work/said" || true)
  case $status in *'"health"'*) ;; *) cat "$work/said" >&2; exit 1 ;; esac
else
  $as_root "$edge" --config "$settings" --check >&2 || echo "note: --check is not content yet" >&2
fi
exit 0
