#!/bin/sh
# no_allocator.sh NM CONTROL REGISTERS EDGE_IO: fails, naming object and symbol, when an object of the
# control path refers to an allocator. Loading (map_file, toml_reader, edge_config) and the fetch thread
# (price_feed) may allocate: before the loop, or away from the control thread.
nm=$1 control=$2 registers=$3 edge_io=$4
found=$(
  for archive in "$control" "$registers" "$edge_io"; do
    "$nm" -A -C -u "$archive"
  done |
    grep -E ':(safety_guard|policy|point_codec|live_points|codec|read_plan|measurement_reader|modbus_frame|modbus_wire|modbus_link|modbus_battery|event_log)\.cpp\.o:' |
    grep -E ' (operator (new|delete)|malloc|calloc|realloc|free|aligned_alloc|posix_memalign|strdup)(\(|\[|$)'
)
if [ -n "$found" ]; then
  echo "the control path refers to an allocator:"
  echo "$found"
  exit 1
fi
