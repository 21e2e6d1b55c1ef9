# Check of a machine's settings with the new program, run there by tools/flash ssh before the
# installation.
#   sh look_ahead.sh PACKAGE SETTINGS MAPS [SUDO]
# Exit codes: 0 accepted, 1 the settings are refused.
package=$1 settings=$2 maps=$3 as_root=${4:-}
# Without settings or maps there is nothing to check.
[ -e "$settings" ] && [ -d "$maps" ] || exit 0
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
dpkg-deb -x "$package" "$work" && chmod 755 "$work"
edge=$work/usr/lib/bess-edge/bin/bess-edge
"$edge" --version >/dev/null 2>&1 || exit 0   # its libraries come with the installation
# A running controller owns the battery, so only status is possible. Its exit code describes the
# controller, and stderr has other messages too: only the answer counts.
status=$($as_root "$edge" status --config "$settings" --json --no-lock 2>"$work/said" || true)
case $status in *'"health"'*) ;; *) cat "$work/said" >&2; exit 1 ;; esac
systemctl is-active --quiet bess-edge || $as_root "$edge" --config "$settings" --check >&2 ||
  echo "note: --check reports problems" >&2
exit 0
