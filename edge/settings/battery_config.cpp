#include "edge/settings/battery_config.h"

#include <cstdio>
#include <string>

#include "edge/log/battery_name.h"
#include "edge/settings/link_config.h"
#include "edge/settings/operator_config.h"

namespace bess {
namespace {

struct CapacityRange {
  std::int64_t least_wh;
  std::int64_t most_wh;
};

/// What a battery of the configured capacity reports.
CapacityRange capacity_range(const BatteryConfig& battery) {
  const std::int64_t capacity_wh = battery.capacity_wh;
  const std::int64_t tolerance_wh = capacity_wh / 4;  // ageing and rounding
  return {.least_wh = capacity_wh - tolerance_wh, .most_wh = capacity_wh + tolerance_wh};
}

/// The battery must report the configured capacity, else the address leads to another one.
void expect_capacity(BatteryConfig& battery) {
  const CapacityRange range = capacity_range(battery);
  for (IdentityCheck& check : battery.map.identity) {
    if (battery.map.points[check.point].name != "capacity") continue;
    check.value_min = range.least_wh;
    check.value_max = range.most_wh;
    check.hint = "is [battery] capacity_wh right, or is this another battery?";
  }
}

/// No battery is that small: the value was given in kW or kWh.
void expect_watts(TomlTable& table, std::string_view key, std::int32_t value, const char* unit) {
  constexpr std::int32_t kLeast = 100;
  if (!table.ok() || !table.has(key) || value >= kLeast) return;
  const std::string given = std::to_string(value);
  table.fail(
      key, "= " + given + " is in " + unit + ": write " + given + "000 for " + given + " k" + unit);
}

}  // namespace

void read_battery(TomlTable table, BatteryConfig& battery, ControlSettings& control) {
  FixedText<255> map_file("maps/alphaess.toml");
  RegisterName variant;
  table.text("name", battery.name);
  if (table.has("name") && table.ok() && !is_battery_name(battery.name.view())) {
    table.fail("name", "must be 1 to 63 letters, digits, - and _");
  }
  table.text("map", map_file);
  table.text("variant", variant);
  read_link(table, battery.link);
  table.integer("power_w", control.guard.power_w, 1, 100'000'000);
  table.integer("capacity_wh", battery.capacity_wh, 1, 1'000'000'000);
  expect_watts(table, "power_w", control.guard.power_w, "W");
  expect_watts(table, "capacity_wh", battery.capacity_wh, "Wh");
  table.integer("start_timeout_s", battery.start_timeout_s, 0, 3'600);
  table.boolean("allow_without_watchdog", battery.allow_without_watchdog);
  int on_other_master = 0;
  table.choice("on_other_master", on_other_master, {"yield", "insist"});
  control.supervision.yields_to_other_master = on_other_master == 0;
  read_full_charge(table, control);
  table.finish();
  check_link(table, battery.link);
  if (!load_linked_map(table, map_file.view(), variant.view(), battery.link, battery.map,
                       battery.map_path)) {
    return;
  }
  if (battery.map.is_meter) return table.fail("map", "is a meter's: it belongs into [meter]");
  expect_capacity(battery);
}

void check_battery_against_map(TomlTable table, const BatteryConfig& battery,
                               const ControlSettings& control) {
  if (!table.ok()) return;
  const std::int32_t power_w = control.guard.power_w;
  if (power_w > battery.map.charge_w_max || power_w > battery.map.discharge_w_max) {
    table.fail("power_w", "= " + std::to_string(power_w) + " is more than the map " +
                              std::string(battery.map.name.view()) + " can express (charge " +
                              std::to_string(battery.map.charge_w_max) + " W, discharge " +
                              std::to_string(battery.map.discharge_w_max) + " W)");
  }
  if (control.control && battery.map.watchdog.duration_s == 0 && !battery.allow_without_watchdog) {
    table.fail("variant",
               "\"" + std::string(battery.map.variant.view()) + "\" of map " +
                   std::string(battery.map.name.view()) +
                   " has no watchdog: if bess-edge dies, the battery follows its last order for "
                   "ever; choose another variant, or add allow_without_watchdog = true");
  }
}

void set_supervision(const BatteryConfig& battery, ControlSettings& control) {
  SupervisionSettings& supervision = control.supervision;
  supervision.response = {.band = battery.map.response,
                          .power_w = control.guard.power_w,
                          .capacity_wh = battery.capacity_wh};
  const CapacityRange range = capacity_range(battery);
  supervision.capacity_wh_min = static_cast<std::int32_t>(range.least_wh);
  supervision.capacity_wh_max = static_cast<std::int32_t>(range.most_wh);
}

FixedText<159> battery_place(const BatteryConfig& battery) {
  const int unit = battery.link.unit >= 0 ? battery.link.unit : battery.map.unit;
  char place[160];
  if (battery.link.rtu) {
    std::snprintf(place, sizeof place, "%s unit %d", battery.link.device.c_str(), unit);
  } else {
    std::snprintf(place, sizeof place, "%s:%d unit %d", battery.link.host.c_str(),
                  battery.link.port, unit);
  }
  return FixedText<159>(place);
}

}  // namespace bess
