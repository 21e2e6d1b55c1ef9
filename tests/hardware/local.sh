#!/bin/sh
# local.sh SOURCE PROGRAMS: the tests on places, on this machine. Exit code 77: what they need is not installed.
cd "$1" || exit 1
/usr/bin/python3 -c 'import labgrid, pytest' 2>/dev/null ||
  { echo "skipped: python3-labgrid or python3-pytest is not installed; tools/setup --test installs them"; exit 77; }
export PYTHONDONTWRITEBYTECODE=1
exec /usr/bin/python3 -m pytest -q -p no:cacheprovider tests/hardware --lg-env tests/hardware/places.yaml --programs "$2"
