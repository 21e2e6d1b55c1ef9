#!/bin/sh
# layers_can_fail.sh TREE FOLDER: shows that layers.sh finds what it forbids. A copy of TREE below
# FOLDER gets wrong lines, and each must be named; without them the copy must pass.
tree=$1 copy=$2
proof=$tree/tests/edge/proofs/layers.sh
rm -rf "$copy" && mkdir -p "$copy" && cp -R "$tree/edge" "$tree/shared" "$tree/tools" \
  "$tree/workstation" "$copy" || exit 1
mkdir "$copy/tests" && cp -R "$tree/tests/trial" "$copy/tests" || exit 1
sh "$proof" "$copy" || { echo "layers.sh complains about a right copy"; exit 1; }
places=$copy/places
wrong() {  # wrong FILE LINE: FILE gets it as its last one
  printf '%s\n' "$2" >>"$copy/$1"
  echo "$1:$(wc -l <"$copy/$1"): $2" >>"$places"
}
wrong shared/features.h '#include "edge/registers/codec.h"'
wrong edge/memory/heap_seal.h '#include "edge/control/tick.h"'
wrong edge/registers/codec.h '#include "edge/control/control_types.h"'
wrong edge/control/tick.h '#include "edge/registers/codec.h"'
wrong edge/control/tick.h '#include "edge/log/journal.h"'
wrong edge/control/policy.cpp '#include <sys/socket.h>'
wrong edge/control/control_types.h '#include "edge/supervision/supervision.h"'
wrong edge/supervision/response.h '#include "edge/site/site_limits.h"'
wrong edge/site/meter_witness.h '#include "edge/loop/tick.h"'
wrong edge/loop/control_loop.h '#include <poll.h>'
wrong edge/battery/modbus_link.cpp '#include "edge/prices/price_feed.h"'
wrong edge/battery/modbus_link.cpp '#include <modbus/modbus.h>'
wrong edge/prices/price_feed.cpp '#include "edge/battery/modbus_link.h"'
wrong edge/log/event_log.cpp '#include <curl/curl.h>'
wrong edge/log/journal.cpp '#include "edge/settings/edge_config.h"'
wrong edge/commands/log_command.cpp '#include <cjson/cJSON.h>'
wrong edge/notify/mail.cpp '#include "edge/settings/edge_config.h"'
wrong edge/settings/edge_config.h '#include "edge/storage/recall.h"'
wrong edge/storage/recall.h '#include "edge/program/controller.h"'
wrong edge/recording/map_check.h '#include "edge/settings/edge_config.h"'
wrong edge/program/startup.h '#include "edge/commands/command_line.h"'
wrong edge/notify/mail.cpp '#include <mosquitto.h>'
wrong tools/hil_runner/scenario/scenario.h '#include "tools/hil_runner/judge/judge.h"'
wrong tools/hil_runner/virtual/virtual_world.h '#include "tools/hil_runner/judge/judge.h"'
wrong workstation/student/student_file.cpp '#include <cjson/cJSON.h>'
wrong edge/settings/edge_config.cpp '#include <toml++/toml.h>'
wrong shared/host/toml_reader.h '#include <toml++/toml.h>'
wrong workstation/chain/run_config.cpp '#include <toml++/toml.h>'
wrong tools/battery_sim/battery_command.cpp '#include <toml++/toml.h>'
wrong workstation/report/figures/html.cpp '#include <pugixml.hpp>'
wrong edge/main.cpp '#include "tools/sim/main.h"'
wrong workstation/cli/evaluate.cpp '#include "edge/control/policy.h"'
wrong shared/features.h '#include "shared/host/file.h"'
wrong edge/control/tick.h '#include "shared/host/toml_reader.h"'
wrong workstation/base/random.h '#include "workstation/market/series/gaps.h"'
wrong workstation/market/series/gaps.h '#include "workstation/market/feed/market_rows.h"'
wrong workstation/market/feed/market_rows.h '#include "workstation/market/model/minute_path.h"'
wrong workstation/env/evaluate.cpp '#include "workstation/planners/baselines.h"'
wrong workstation/planners/baselines.cpp '#include "workstation/rl/teacher.h"'
wrong workstation/rl/teacher.h '#include "workstation/student/student_policy.h"'
wrong workstation/correction/distil.cpp '#include "workstation/student/verify.h"'
wrong workstation/student/verify.cpp '#include "workstation/report/figures/figure.h"'
wrong workstation/report/figures/html.cpp '#include "workstation/chain/run_config.h"'
wrong workstation/chain/run_config.cpp '#include "workstation/run/run_record.h"'
wrong workstation/run/run_stages.cpp '#include "workstation/cli/commands.h"'
wrong tools/battery_sim/bus_reply.cpp '#include "edge/battery/modbus_frame.h"'
wrong tests/trial/trial_battery.h '#include "tools/battery_sim/simulated_battery.h"'
found=$(sh "$proof" "$copy") && { echo "layers.sh passed a wrong copy"; exit 1; }
while read -r place line; do
  printf '%s\n' "$found" | grep -q "^$place" && continue
  echo "layers.sh did not find $place $line"
  exit 1
done <"$places"
rm -rf "$copy/edge/log"
! sh "$proof" "$copy" >/dev/null || { echo "layers.sh passed a tree without edge/log"; exit 1; }
rm -rf "$copy"
