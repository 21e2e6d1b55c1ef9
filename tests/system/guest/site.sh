# Sourced by machine.sh and emulator.sh: parts of their guests.
#   site_into ROOT        simulated battery and market, started at each boot before bess-edge;
#                         ROOT/opt/bess-site/lib is for the libraries of bess-sim
#   raspberry_image FILE ROOT   an image in the layout of Raspberry Pi OS, FAT before ext4, with
#                               that system
#   program LINE          for variant: a program with normal answers that controls by that line
#   variant VERSION [COMMAND]   FOLDER/bess-edge_VERSION.deb: $package with another version, changed
#                               by the command in its tree
# Uses $source, $folder and $programs (folder of bess-sim).
site_into() {
  local site=$1/opt/bess-site
  mkdir -p "$site/lib" "$1/etc/bess"
  cp "$programs/bess-sim" "$source/edge/device/maps/alphaess.toml" \
    "$source/tests/system/guest/start_site" \
    "$source/tests/system/guest/edge.toml.in" "$site/"
  awk 'BEGIN { print "minute_utc,indicative_eur_mwh,settled_eur_mwh"
    for (m = -60; m < 7200; ++m) { p = 100 + 900 * sin(m / 40)
      printf "%s,%.2f,%.2f\n", strftime("%Y-%m-%dT%H:%M:%SZ", 1679788800 + 60 * m, 1), p, p
    } }' >"$site/minutes.csv"
  cp "$source/tests/system/guest/bess-site.service" "$1/etc/systemd/system/"
  ln -s /etc/systemd/system/bess-site.service "$1/etc/systemd/system/multi-user.target.wants/"
  ln -sf /dev/null "$1/etc/systemd/system/time-sync.target"       # simulated time
}

raspberry_root_offset=$((34816 * 512))
raspberry_image() {
  local size_mb=$(($(du -sm "$2" | cut -f1) * 3 / 2 + 100))
  rm -f "$1"
  truncate -s $((size_mb + 17))M "$1"
  printf 'label: dos\nstart=2048, size=32768, type=c\nstart=34816, type=83\n' | sfdisk -q "$1"
  mformat -i "$1@@1048576" -T 32768 -h 16 -s 63 ::
  echo "console=tty1 root=PARTUUID=1-02 rootwait" | mcopy -i "$1@@1048576" - ::cmdline.txt
  mke2fs -q -t ext4 -d "$2" -E offset=$raspberry_root_offset "$1" $((size_mb - 2))M
}

program() {
  printf '%s' "cd usr/lib/bess-edge/bin && mv bess-edge real && printf '#!/bin/sh\\ncase \"\$1\" in status|log|signature|trial|history) exec \$(dirname \$(readlink -f \$0))/real \"\$@\" ;; esac\\n$1\\n' >bess-edge && chmod 755 bess-edge"
}

variant() {
  local tree=$folder/variant file=$folder/bess-edge_$1.deb
  rm -rf "$tree"
  dpkg-deb -R "$package" "$tree"
  sed -i "s/^Version: .*/Version: $1/" "$tree/DEBIAN/control"
  sed -i "s/\"version\": \"[^\"]*\"/\"version\": \"$1\"/" \
    "$tree/usr/lib/bess-edge/share/certificate.json"
  (cd "$tree" && sh -c "${2:-true}")
  (cd "$tree/usr/lib/bess-edge" &&
    find bin share systemd -type f | LC_ALL=C sort | xargs sha256sum >SUMS)
  dpkg-deb --root-owner-group -Zgzip -b "$tree" "$file" >/dev/null
  rm -rf "$tree"
}
