#!/bin/sh
# no_allocator.sh NM CONTROL REGISTERS EDGE_IO: fails, naming object and symbol, when an object of the
# control path refers to an allocator. Loading (map_file, toml_reader, edge_config) and the fetch thread
# (price_feed) may allocate: before the loop, or away from the control thread.
nm=$1 control=$2 registers=$3 edge_io=$4
control_path='safety_guard|policy|codec|modbus_link|modbus_battery'
# The log: handed over by the control thread, written by a thread that may not allocate either.
log_path='event_log|log_text|journal|record_codec|ring_log|run_status|whole_file|instance_lock|service_notify'
found=$(
  for archive in "$control" "$registers" "$edge_io"; do
    "$nm" -A -C -u "$archive"
  done |
    grep -E ":($control_path|$log_path)\.cpp\.o:" |
    grep -E ' (operator (new|delete)|malloc|calloc|realloc|free|aligned_alloc|posix_memalign|strdup)(\(|\[|$)'
)
if [ -n "$found" ]; then
  echo "the control path refers to an allocator:"
  echo "$found"
  exit 1
fi

# stdio streams have buffers on the heap and locks; texts are built with snprintf and written with write(2).
found=$("$nm" -A -C -u "$edge_io" | grep -E ":($log_path)\.cpp\.o:" |
  grep -E ' (fopen|fdopen|fprintf|printf|dprintf|__printf_chk|__fprintf_chk|puts|fputs|putchar|fwrite|fflush|std::cout|std::cerr)')
if [ -n "$found" ]; then
  echo "the log uses a stdio stream:"
  echo "$found"
  exit 1
fi
# A renamed file would leave the lists without a word.
for object in $(echo "$log_path" | tr '|' ' '); do
  "$nm" -A "$edge_io" 2>/dev/null | grep -q ":$object\.cpp\.o:" || {
    echo "$object.cpp is not in $edge_io any more: mend the list in $0"
    exit 1
  }
done
