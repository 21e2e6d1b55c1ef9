#!/bin/sh
# layers.sh TREE: fails, naming file and line, when a file below TREE includes what its layer must not know:
# another part of the project, or a library that a part has for itself. A folder that is no longer there
# fails as well: a renamed one must not slip through.
cd "$1" || exit 1
status=0
includes() { grep -rnH --include='*.h' --include='*.cpp' "^#include $1" $2; }  # PATTERN FOLDERS
blame() {  # blame FOUND WHY
  [ -z "$1" ] && return
  printf '%s\n' "$1" | while read -r line; do echo "$line    ($2)"; done
  status=1
}

# layer PLACE ALLOWED...: of the project, PLACE includes files below ALLOWED alone.
layer() {
  place=$1
  shift
  [ -e "$place" ] || { echo "$place is not there: was it renamed?"; status=1; return; }
  allowed=$(printf '|%s' "$@")
  blame "$(includes '"' "$place" | grep -vE ":#include \"(${allowed#|})/")" "$place may include: $*"
}
layer shared             shared
layer edge/memory        edge/memory shared
layer edge/registers     edge/registers shared
layer edge/control       edge/control edge/registers shared
layer edge/battery       edge/battery edge/control edge/registers shared
layer edge/prices        edge/prices edge/control edge/memory shared
layer edge/log           edge/log edge/control edge/memory shared
layer edge/program       edge shared
layer edge/main.cpp      edge shared
layer tools/battery_sim  tools edge/registers shared
layer tools/market_sim   tools shared
layer tools/settle       tools shared
layer tools/sim          tools shared
layer workstation        workstation shared

# only HEADER OWNERS: of the edge and shared, only files whose path begins with OWNERS include <HEADER>.
only() { blame "$(includes "<$1" "edge shared" | grep -vE "^($2)")" "only $2 knows $1"; }
only modbus/ edge/battery/modbus_wire.cpp:
only curl/   edge/prices/
only cjson/  'edge/prices/|edge/program/status_command.cpp:'
only toml++/ edge/registers/toml_reader.h:

# The control layer knows neither files, sockets, threads nor signals.
io='<(sys/|arpa/|net|poll|unistd|fcntl|pthread|signal|semaphore|cstdio|stdio|fstream|iostream|thread|mutex)'
blame "$(grep -rnHE "^#include $io" edge/control)" "edge/control knows no io"
exit $status
