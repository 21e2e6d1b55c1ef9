# Package selection and checks, sourced by the commands of tools/flash.
#   package_for ARCH RELEASE [FILE]   prints FILE, or the newest package for both; RELEASE is the
#                             codename in the machine's /etc/os-release
#   require_package FILE      fails unless it is a package of bess-edge
#   require_whole FILE        fails unless the archive can be read to the end
#   require_certified FILE    fails unless the package has a proved student with its certificate
# They call die of the sourcing command.

flashing_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../.." && pwd)
# shellcheck source=tools/delivery/packaging/release.sh
. "$flashing_root/tools/delivery/packaging/release.sh"

require_package() {
  [ -f "$1" ] || die "$1: no such package"
  [ "$(dpkg-deb -f "$1" Package 2>/dev/null)" = bess-edge ] ||
    die "$1: is not a package of bess-edge"
}

package_for() {
  local release=$2 file=${3:-} suffix make found
  is_release "$release" || release=$own_release
  suffix=$(suffix_of "$release")
  make="make it with: tools/package ${suffix:+--release $release }$1"
  if [ -z "$file" ]; then
    file=$(find "$flashing_root/build-packages$suffix" -name "bess-edge_*_$1.deb" \
      -printf '%T@ %p\n' 2>/dev/null | sort -n | tail -n 1 | cut -d' ' -f2-)
    [ -n "$file" ] || die "build-packages$suffix/ has no bess-edge for $1; $make"
  fi
  require_package "$file"
  found=$(dpkg-deb -f "$file" Architecture)
  [ "$found" = "$1" ] || die "$file is for $found, the machine is $1; $make"
  # For a version without a mark, apt checks the dependencies.
  found=$(release_of "$file")
  [ "${found:-$release}" = "$release" ] ||
    die "$file is for $found, the machine has $release; $make"
  echo "$file"
}

# Reads the whole archive, to detect truncated packages.
require_whole() {
  dpkg-deb --fsys-tarfile "$1" 2>/dev/null | tar -t >/dev/null 2>&1 ||
    die "${1##*/} is damaged: its archive cannot be read to the end"
}

require_certified() {
  require_whole "$1"
  local work
  work=$(mktemp -d)
  dpkg-deb --fsys-tarfile "$1" | tar -x -C "$work" ./usr/lib/bess-edge/share/certificate.json \
    ./usr/lib/bess-edge/share/student_weights.h 2>/dev/null || true
  local said
  said=$("$flashing_root/tools/delivery/packaging/certificate" check \
    "$work/usr/lib/bess-edge/share/student_weights.h" \
    "$work/usr/lib/bess-edge/share/certificate.json" 2>&1) || {
    rm -rf "$work"
    die "${1##*/}: ${said//$work/}"
  }
  rm -rf "$work"
}
