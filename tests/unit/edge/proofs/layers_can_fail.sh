#!/bin/sh
# layers_can_fail.sh TREE FOLDER: shows that layers.sh finds violations. A copy of TREE below FOLDER
# gets wrong lines, and each must be named; without them the copy must pass.
tree=$1 copy=$2
proof=$tree/tests/unit/edge/proofs/layers.sh
rm -rf "$copy" && mkdir -p "$copy" && cp -R "$tree/edge" "$tree/shared" "$tree/tools" \
  "$tree/workstation" "$copy" || exit 1
mkdir -p "$copy/tests/system" && cp -R "$tree/tests/system/trial" "$copy/tests/system" || exit 1
sh "$proof" "$copy" || { echo "layers.sh refuses a correct copy"; exit 1; }
places=$copy/places
wrong() {  # wrong FILE LINE: FILE gets it as its last one
  printf '%s\n' "$2" >>"$copy/$1"
  echo "$1:$(wc -l <"$copy/$1"): $2" >>"$places"
}
wrong shared/features.h '#include "edge/device/registers/codec.h"'
wrong shared/features.h '#include "shared/host/file.h"'
wrong edge/core/control/tick.h '#include "edge/device/registers/codec.h"'
wrong edge/core/control/tick.h '#include "edge/records/log/journal.h"'
wrong edge/core/control/tick.h '#include "shared/host/toml_reader.h"'
wrong edge/core/control/policy.cpp '#include <sys/socket.h>'
wrong edge/core/loop/control_loop.h '#include <poll.h>'
wrong edge/device/battery/modbus_link.cpp '#include "edge/prices/record/published_prices.h"'
wrong edge/device/battery/modbus_link.cpp '#include <modbus/modbus.h>'
wrong edge/records/log/journal.cpp '#include "edge/app/settings/edge_config.h"'
wrong edge/records/log/event_log.cpp '#include <curl/curl.h>'
wrong edge/prices/record/price_reader.cpp '#include "edge/prices/fetch/fetch.h"'
wrong edge/app/commands/log_command.cpp '#include <cjson/cJSON.h>'
wrong edge/app/settings/edge_config.cpp '#include <toml++/toml.h>'
wrong edge/app/program/startup.h '#include "edge/prices/fetch/fetch.h"'
wrong edge/companions/notify/notifier.cpp '#include "edge/app/settings/edge_config.h"'
wrong edge/companions/notify/notifier.cpp '#include <mosquitto.h>'
wrong edge/main.cpp '#include "tools/simulators/sim/commands.h"'
wrong shared/host/toml_reader.h '#include <toml++/toml.h>'
wrong tools/simulators/battery_sim/bus_reply.cpp '#include "edge/device/battery/modbus_frame.h"'
wrong tools/hil_runner/judge/judge.h '#include "tools/hil_runner/virtual/virtual_world.h"'
wrong tests/system/trial/trial_battery.h '#include "tools/simulators/sim/commands.h"'
wrong workstation/base/random.h '#include "workstation/data/market/series/plausibility.h"'
wrong workstation/data/env/evaluate.cpp '#include "workstation/policy/planners/baselines.h"'
wrong workstation/policy/rl/teacher.h '#include "workstation/correction/student/student_policy.h"'
wrong workstation/correction/student/verify.cpp '#include "workstation/report/figures/html.h"'
wrong workstation/correction/student/student_file.cpp '#include <cjson/cJSON.h>'
wrong workstation/report/figures/html.cpp '#include "workstation/runs/chain/run_config.h"'
wrong workstation/report/figures/html.cpp '#include <pugixml.hpp>'
wrong workstation/runs/run/run_stages.cpp '#include "workstation/cli/commands.h"'
wrong workstation/runs/chain/run_config.cpp '#include <toml++/toml.h>'
wrong workstation/cli/evaluate.cpp '#include "edge/core/control/policy.h"'
found=$(sh "$proof" "$copy") && { echo "layers.sh passed a wrong copy"; exit 1; }
while read -r place line; do
  printf '%s\n' "$found" | grep -q "^$place" && continue
  echo "layers.sh did not find $place $line"
  exit 1
done <"$places"
rm -rf "$copy/edge/records"
! sh "$proof" "$copy" >/dev/null || { echo "layers.sh passed a tree without edge/records"; exit 1; }
rm -rf "$copy"
