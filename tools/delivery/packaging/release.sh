# Debian releases of the packages; to be sourced.
#   own_release     release of this machine, bookworm or trixie; in a root of another release
#                   (tools/package) BESS_OWN_RELEASE, that of the host
#   is_release R    whether R is supported
#   suffix_of R     folder suffix of a release: empty for that of this machine, else -trixie
#   mark_of R       version suffix of a release: +deb12, +deb13
#   release_of DEB  release by that suffix; empty: no suffix
own_release=${BESS_OWN_RELEASE:-$(. /etc/os-release && echo "${VERSION_CODENAME:-}")}
[ "$own_release" = trixie ] || own_release=bookworm
is_release() { [[ "$1" =~ ^(bookworm|trixie)$ ]]; }
suffix_of() { [ "$1" = "$own_release" ] || echo "-$1"; }
mark_of() { if [ "$1" = trixie ]; then echo +deb13; else echo +deb12; fi; }
release_of() {
  dpkg-deb -f "$1" Version | sed -n 's/.*+deb12$/bookworm/p; s/.*+deb13$/trixie/p'
}
