#!/bin/sh
# local.sh SOURCE PROGRAMS [emulated]: tests on places on this machine, or with the Raspberry Pi's
# programs of build-aarch64, emulated. Exit code 77: a requirement is missing.
cd "$1" || exit 1
/usr/bin/python3 -c 'import labgrid, pytest' 2>/dev/null ||
  {
    echo "skipped: python3-labgrid or python3-pytest is not installed;" \
      "tools/setup --test installs them"
    exit 77
  }
if [ "${3:-}" = emulated ]; then
  folder=${BESS_AARCH64:-build-aarch64}
  [ -x "$folder/bess-edge" ] && [ -x "$folder/bess-sim" ] &&
    command -v qemu-aarch64-static >/dev/null ||
    { echo "skipped: nothing to emulate; tools/test --full builds build-aarch64"; exit 77; }
  set -- --place emulated
else
  set -- --programs "$2"
fi
export PYTHONDONTWRITEBYTECODE=1
exec /usr/bin/python3 -m pytest -q -p no:cacheprovider tests/system/hardware \
  --lg-env tests/system/hardware/places.yaml "$@"
