#include "tools/battery_sim/battery_file.h"

#include "shared/battery_keys.h"
#include "shared/host/toml_reader.h"
#include "shared/host/user_error.h"

namespace bess {

void read_battery_file(const std::string& path, BatteryParameters& battery) {
  std::string error;
  TomlValue document;
  if (!parse_toml_file(path, document, error)) throw UserError(error);
  TomlTable table(document.find("battery"), path, "[battery]", error);
  if (document.find("battery") == nullptr) fail("{}: has no [battery]", path);
  for (const BatteryKey& key : kBatteryKeys) {
    table.number(key.name, key.of(battery), key.low, key.high);
  }
  for (const char* of_workstation : {"wear_eur_per_mwh", "cycles_per_day_max", "initial_soc",
                                     "fade_percent_per_1000_cycles", "minimum_run_min"}) {
    double ignored = 0;  // a simulator has none of it, and the workstation's file may
    table.number(of_workstation, ignored, 0, 1'000);
  }
  table.finish();
  if (!error.empty()) throw UserError(error);
  if (const char* wrong = battery_contradiction(battery)) fail("{}: [battery] {}", path, wrong);
}

}  // namespace bess
