# Sourced: made_up_package FOLDER ARCH VERSION: a package like bess-edge, certified, without its
# programs. The source tree is $source.
made_up_package() {
  local tree
  tree=$(mktemp -d)
  mkdir -p "$tree/DEBIAN" "$tree/usr/lib/bess-edge/share/maps" "$tree/usr/bin" "$1"
  printf '%s\n' "Package: bess-edge" "Version: $3" "Architecture: $2" \
    "Maintainer: nobody <nobody@localhost>" "Installed-Size: 2000" "Depends: libc6, libcurl4" \
    "Description: made up" >"$tree/DEBIAN/control"
  cp "$source/edge/generated/student_weights.h" "$tree/usr/lib/bess-edge/share/"
  cp "$source/edge/device/maps/alphaess.toml" "$tree/usr/lib/bess-edge/share/maps/"
  "$source/tools/delivery/packaging/certificate" make \
  "$tree/usr/lib/bess-edge/share/student_weights.h" \
    "$3" abc \
    "$(cat "$source/edge/generated/decision_signature.txt")" \
    >"$tree/usr/lib/bess-edge/share/certificate.json"
  [ -z "${spoil:-}" ] || (cd "$tree/usr/lib/bess-edge/share" && sh -c "$spoil")
  dpkg-deb --root-owner-group -Zgzip -b "$tree" "$1/bess-edge_$3_$2.deb" >/dev/null
  rm -rf "$tree"
  echo "$1/bess-edge_$3_$2.deb"
}
