#!/bin/sh
# layers.sh TREE: fails, naming file and line, when a file below TREE includes what its layer must
# not know: another part of the project, or a library that a part has for itself. A folder that is
# no longer there fails as well: a renamed one must not slip through.
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
  blame "$(includes '"' "$place" | grep -vE ":#include \"(${allowed#|})(/|\")")" \
    "$place may include: $*"
}
layer shared                        shared
layer shared/host                   shared
blame "$(includes '"shared/host' "$(echo shared/*.h shared/*.cpp) shared/nn")" \
  "the integer part of shared knows no host"
# The edge, from the ground up. What uses the heap at start-up is named: the control path may not.
layer edge/base                     edge/base shared
layer edge/memory                   edge/memory edge/base shared
layer edge/control                  edge/control edge/base shared
layer edge/supervision              edge/supervision edge/control edge/base shared
layer edge/site                     edge/site edge/control edge/base shared
layer edge/loop                     edge/loop edge/supervision edge/site edge/control edge/base \
  shared
layer edge/registers                edge/registers edge/control/power_order.h edge/base shared
layer edge/battery                  edge/battery edge/control edge/registers edge/base shared
layer edge/log                      edge/log edge/control edge/memory edge/base shared
prices_stand_on="edge/prices edge/log edge/control edge/memory edge/base shared"
layer edge/prices                   $prices_stand_on
grounds="edge/battery edge/control edge/loop edge/site edge/supervision edge/registers"
grounds="$grounds $prices_stand_on"
layer edge/settings                 edge/settings $grounds
layer edge/recording                edge/recording $grounds
layer edge/storage                  edge/storage edge/settings $grounds
layer edge/program                  edge/program edge/storage edge/recording edge/settings $grounds
layer edge/commands                 edge/commands edge/account edge/why edge/program \
  edge/storage edge/recording edge/settings $grounds
layer edge/main.cpp                 edge shared
# bess-prices: by itself, with the heap.
layer edge/fetch                    edge/fetch edge/account edge/companion edge/storage \
  edge/settings $grounds
# Beside the controller: they read what the log wrote.
layer edge/account                  edge/account edge/log edge/control edge/base shared
layer edge/why                      edge/why edge/log edge/loop edge/control edge/base shared
layer edge/companion                edge/companion edge/log edge/control edge/base shared
layer edge/notify                   edge/notify edge/companion edge/account/settled_prices.h \
  edge/log edge/storage/instance_lock.h edge/settings/retired_keys.h shared
layer edge/page                     edge/page edge/companion edge/why edge/settings/retired_keys.h \
  edge/control edge/base shared
blame "$(includes '"shared/host' edge |
  grep -vE '^edge/(registers/map_|settings/|recording/|storage/|program/|commands/|account/)' |
  grep -vE '^edge/(why/|companion/|notify/|page/|fetch/)')" \
  "the heap is of start-up, commands, companion programs, and the reader of register maps"
# The simulators.
layer tools/battery_sim             tools edge/registers edge/base shared
layer tools/market_sim              tools shared
layer tools/settle                  tools shared
layer tools/sim                     tools shared
layer tools/site                    tools/site tools/sim shared
# Independent of the simulators, whose mistakes it must not share.
layer tests/trial                   tests/trial tests/support/thorough.h edge/program/take_over.h \
  edge/loop edge/control edge/base shared
# Beside the real programs it runs the edge's own objects in virtual time.
h=tools/hil_runner
around="tools/sim tools/site tools/battery_sim tools/market_sim edge shared"
layer $h/base                       $h/base shared
layer $h/scenario                   $h/scenario $around
layer $h/evidence                   $h/evidence $around
# It shares nothing with what it looks at.
layer $h/witness                    $h/witness
layer $h/judge                      $h/judge $h/evidence $h/scenario $around
layer $h/virtual                    $h/virtual $h/witness $h/evidence $h/scenario $h/base $around
layer $h/real                       $h/real $h/evidence $h/scenario $h/base $around
layer $h/wall                       $h/wall $h/real $h/evidence $h/scenario $h/base $around
layer $h/run                        $h $around
# The workstation, in the order in which data flows.
w=workstation
layer $w/base                       $w/base shared
layer $w/market/series              $w/market/series $w/base shared
layer $w/market/feed                $w/market/feed $w/market/series $w/base shared
layer $w/market/model               $w/market/model $w/market/series $w/base shared
layer $w/market/statistics          $w/market/statistics $w/market/series $w/base shared
layer $w/env                        $w/env $w/market/series $w/base shared
layer $w/rules                      $w/rules $w/env $w/base shared
layer $w/planners                   $w/planners $w/env $w/base shared
layer $w/nn                         $w/nn $w/base shared
layer $w/backtest                   $w/backtest $w/env $w/market/series $w/base shared
layer $w/rl                         $w/rl $w/nn $w/planners $w/env $w/base shared
layer $w/correction                 $w/correction $w/rules $w/rl $w/nn $w/env $w/base shared
layer $w/student                    $w/student $w/correction $w/rules $w/rl $w/nn $w/env $w/base \
  shared student_weights.h
taught="$w/student $w/correction $w/rl $w/rules $w/env $w/market/series $w/base"
layer $w/report/figures  $w/report/figures $w/backtest $w/market/statistics $taught shared
shown="$w/planners/foresight.h $w/planners/baselines.h"
layer $w/report                     $w/report $w/backtest $w/market/statistics $shown $taught shared
market="$w/market/series $w/market/feed $w/market/model $w/market/statistics"
learnt="$w/student $w/correction $w/rules $w/rl $w/nn $w/planners $w/env $market $w/base"
layer $w/chain                      $w/chain $learnt shared
layer $w/run                        $w/run $w/chain $w/report $w/backtest $learnt shared
layer $w/sweep                      $w/sweep $w/run $w/chain $w/report $learnt shared
layer $w/size                       $w/size $w/chain $w/report $w/backtest $learnt shared
layer $w/impact                     $w/impact $w/chain $w/report $learnt shared
layer $w/log                        $w/log $w/chain $w/report $learnt shared
layer $w/cli                        $w shared
layer $w/main.cpp                   $w shared

# only HEADER OWNERS [PLACES]: of PLACES, the edge and shared unless given, only files whose path
# begins with OWNERS include <HEADER>.
only() { blame "$(includes "<$1" "${3:-edge shared}" | grep -vE "^($2)")" "only $2 knows $1"; }
only modbus/ edge/battery/modbus_wire.cpp:
only curl/   'edge/fetch/fetch.cpp:|edge/notify/mqtt_client.cpp:|shared/host/http_client.cpp:'
only mosquitto.h edge/notify/mqtt_client.cpp: 'edge shared workstation tools'
only cjson/  'shared/host/json.cpp:' 'edge shared workstation tools'
only toml++/ shared/host/toml_document.cpp: 'edge shared workstation tools'
reports='(workstation/report/figures/figure|tools/hil_runner/run/report_page).cpp'
only pugixml "(workstation/market/feed/entsoe_element.h|$reports):" 'edge shared workstation tools'

# The control layer knows neither files, sockets, threads nor signals.
io='<(sys/|arpa/|net|poll|unistd|fcntl|pthread|signal|semaphore|cstdio|stdio|fstream|iostream|thread|mutex)'
blame "$(grep -rnHE "^#include $io" edge/control edge/supervision edge/site edge/loop)" \
  "the control layer knows no io"
exit $status
