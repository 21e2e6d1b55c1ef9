#!/bin/sh
# layers.sh TREE: fails, naming file and line, if a file below TREE includes what its layer must not
# use: another part of the project, or another part's private library. A missing folder fails as
# well, so that a rename is noticed.
cd "$1" || exit 1
status=0
includes() { grep -rnH --include='*.h' --include='*.cpp' "^#include $1" $2; }  # PATTERN FOLDERS
blame() {  # blame FOUND WHY
  [ -z "$1" ] && return
  printf '%s\n' "$1" | while read -r line; do echo "$line    ($2)"; done
  status=1
}

# layer PLACE ALLOWED...: of the project, PLACE only includes files below ALLOWED.
layer() {
  place=$1
  shift
  [ -e "$place" ] || { echo "$place is not there: was it renamed?"; status=1; return; }
  allowed=$(printf '|%s' "$@")
  blame "$(includes '"' "$place" | grep -vE ":#include \"(${allowed#|})(/|\")")" \
    "$place may include: $*"
}
layer shared                        shared
layer shared/host                   shared
blame "$(includes '"shared/host' "$(echo shared/*.h shared/*.cpp) shared/nn")" \
  "the integer part of shared knows no host"
# The edge: the decision parts use nothing else; then the battery, the records of each control
# cycle, the published price, and the program around them.
e=edge
layer $e/core                       $e/core shared
layer $e/device                     $e/device $e/core shared
layer $e/records                    $e/records $e/core shared
layer $e/prices/record              $e/prices/record $e/records/log $e/core shared
controls="$e/prices/record $e/records $e/device $e/core"
layer $e/app                        $e/app $controls shared
layer $e/main.cpp                   $e shared
# Other programs, with the heap. Companions read its files.
layer $e/prices/fetch               $e/prices/fetch $e/companions/common $e/app/storage \
  $e/app/settings $controls shared
layer $e/companions                 $e/companions $e/records $e/core shared \
  $e/app/settings/retired_keys.h $e/app/storage/instance_lock.h
blame "$(includes '"shared/host' $e |
  grep -vE '^edge/(device/registers/map_|app/|records/(account|why)/|companions/|prices/fetch/)')" \
  "the heap is of start-up, commands, companion programs, and the reader of register maps"
# The simulators, and the trial, which must not share their errors.
layer tools/simulators              tools/simulators $e/device/registers $e/core/base shared
layer tests/system/trial            tests/system/trial tests/support/thorough.h \
  $e/app/program/restored_run.h $e/core shared
# It runs the edge's own objects in virtual time, and the real programs; the witness is independent
# of the decoded device.
h=tools/hil_runner
layer $h                            $h tools/simulators $e shared
layer $h/witness                    $h/witness
layer $h/judge                      $h/judge $h/evidence $h/scenario tools/simulators $e shared
# The workstation, in the order in which data flows.
w=workstation
layer $w/base                       $w/base shared
layer $w/data                       $w/data $w/base shared
layer $w/policy                     $w/policy $w/data $w/base shared
layer $w/correction                 $w/correction $w/policy $w/data $w/base shared student_weights.h
layer $w/report                     $w/report $w/correction $w/policy $w/data $w/base shared
layer $w/runs                       $w/runs $w/report $w/correction $w/policy $w/data $w/base shared
layer $w/cli                        $w shared

# only HEADER OWNERS [PLACES]: in PLACES, by default the edge and shared, only files whose path
# begins with OWNERS include <HEADER>.
only() { blame "$(includes "<$1" "${3:-edge shared}" | grep -vE "^($2)")" "only $2 knows $1"; }
only modbus/ edge/device/battery/modbus_wire.cpp:
only curl/ '(edge/(prices/fetch/fetch|companions/notify/mqtt_client)|shared/host/http_client).cpp:'
only mosquitto.h edge/companions/notify/mqtt_client.cpp: 'edge shared workstation tools'
only cjson/  'shared/host/json.cpp:' 'edge shared workstation tools'
only toml++/ shared/host/toml_document.cpp: 'edge shared workstation tools'
only pugixml '(workstation/data/market/feed/entsoe.cpp:|tools/hil_runner/run/report_page)' \
  'edge shared workstation tools'

# The decision parts use neither files, sockets, threads nor signals.
io='(sys/|arpa/|net|poll|unistd|fcntl|pthread|signal|semaphore|cstdio|stdio|fstream|iostream)'
decides="$e/core/control $e/core/supervision $e/core/site $e/core/loop"
blame "$(grep -rnHE "^#include <($io|thread|mutex)" $decides)" "what decides knows no io"
exit $status
