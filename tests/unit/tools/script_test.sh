# Sourced: start of the script tests. $source is the tree, $folder the test's own.
failures=0
fail() { echo "FAILED: $*"; failures=$((failures + 1)); }
need() {  # need PROGRAM...: else the test is skipped
  local program
  for program in "$@"; do
    command -v "$program" >/dev/null || { echo "$program is not installed"; exit 77; }
  done
}
enter_folder() { rm -rf "$folder"; mkdir -p "$folder"; cd "$folder"; }
