# Sourced: the Debian releases that packages are made for.
#   own_release     bookworm or trixie: this machine's. BESS_OWN_RELEASE is that of the machine
#                   around the root of another release that tools/package works in.
#   is_release R    whether R is one of them
#   suffix_of R     of the folders of that release: nothing for this machine's own, else -trixie
#   mark_of R       the end of its packages' versions: +deb12, +deb13
#   release_of DEB  by that mark; nothing: the package has none
own_release=${BESS_OWN_RELEASE:-$(. /etc/os-release && echo "${VERSION_CODENAME:-}")}
[ "$own_release" = trixie ] || own_release=bookworm
is_release() { [[ "$1" =~ ^(bookworm|trixie)$ ]]; }
suffix_of() { [ "$1" = "$own_release" ] || echo "-$1"; }
mark_of() { if [ "$1" = trixie ]; then echo +deb13; else echo +deb12; fi; }
release_of() {
  dpkg-deb -f "$1" Version | sed -n 's/.*+deb12$/bookworm/p; s/.*+deb13$/trixie/p'
}
