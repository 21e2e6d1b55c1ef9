#include "edge/app/settings/edge_config.h"

#include <arpa/inet.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>

#include "edge/core/control/full_charge.h"
#include "edge/device/registers/map_file.h"
#include "edge/records/log/battery_name.h"
#include "shared/host/text.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {

namespace {

bool is_numeric_ipv4(const char* host) {
  in_addr address{};
  return inet_pton(AF_INET, host, &address) == 1;
}

/// Link settings that the operator omits are the manufacturer's defaults from the map.
void complete_link(TomlTable& table, BatteryLinkSettings& link, RegisterMap& map) {
  if (!table.has("port")) link.port = map.port;
  if (!table.has("baud")) link.baud = map.baud;
  if (!table.has("parity")) link.parity = map.parity;
  if (!table.has("stop_bits")) link.stop_bits = map.stop_bits;
  TomlTable units(table.table("units"), table.file(), table.where() + " units", table.error());
  for (UnitGroup& group : map.unit_groups) units.integer(group.name.view(), group.unit, 0, 255);
  units.finish();
}

// Keys of a Modbus connection and its register map, the same in [battery] and [meter].

/// Reads transport, host, port, device, baud, parity, stop_bits, unit and response_timeout_ms;
/// load_linked_map reads units. Call before `finish`.
void read_link(TomlTable& table, BatteryLinkSettings& link) {
  table.choice("transport", link.rtu, {"tcp", "rtu"});
  table.text("host", link.host);
  table.integer("port", link.port, 1, 65'535);
  table.text("device", link.device);
  table.integer("baud", link.baud, 1'200, 230'400);
  table.choice("parity", link.parity, {"none", "even", "odd"});
  table.integer("stop_bits", link.stop_bits, 1, 2);
  table.integer("unit", link.unit, 0, 255);
  table.integer("response_timeout_ms", link.response_timeout_ms, 10, 30'000);
  static_cast<void>(table.table("units"));
}

/// Rejects an impossible connection; call after `finish`.
void check_link(TomlTable& table, const BatteryLinkSettings& link) {
  if (!is_serial_speed(link.baud)) {
    table.fail("baud", "must be a speed of serial lines such as 9600, 19200 or 115200");
  }
  if (!link.rtu && !is_numeric_ipv4(link.host.c_str())) {
    table.fail("host",
               "must be a numeric IPv4 address such as \"192.168.1.20\": a name would need a "
               "resolver at every reconnect");
  }
}

/// Loads the map of the table, relative to its file, and completes `link` with the map's defaults.
/// `path` is the map's. False with the table's error set.
bool load_linked_map(TomlTable& table, std::string_view map_file, std::string_view variant,
                     BatteryLinkSettings& link, RegisterMap& map, FixedText<511>& path) {
  if (!table.ok()) return false;
  const std::string map_path = table.resolved(map_file);
  if (!path.assign(map_path)) table.fail("map", "is too long");
  if (access(map_path.c_str(), R_OK) != 0) {
    table.fail("map", "= " + map_path + " cannot be read: " + std::strerror(errno) +
                          "; installed maps are in share/bess/maps, meter maps in "
                          "share/bess/meters");
    return false;
  }
  if (!load_register_map(map_path, variant, map, table.error())) return false;
  complete_link(table, link, map);
  return table.ok();
}

constexpr std::int64_t kConnectionWMax = 100'000'000;

void read_connection(TomlTable& table, ConnectionSettings& connection) {
  table.integer("import_w_max", connection.import_w_max, 0, kConnectionWMax);
  table.integer("export_w_max", connection.export_w_max, 0, kConnectionWMax);
  table.integer("peak_w_max", connection.peak_w_max, 1, kConnectionWMax);
  table.integer("margin_w", connection.margin_w, 0, kConnectionWMax);
  table.boolean("peak_shave", connection.peak_shave);
}

void check_connection(TomlTable& table, const ConnectionSettings& connection) {
  for (const char* const key : {"import_w_max", "peak_w_max"}) {
    const std::int32_t limit_w = key[0] == 'i' ? connection.import_w_max : connection.peak_w_max;
    if (limit_w <= connection.margin_w) {
      table.fail(key, "must be above margin_w (" + std::to_string(connection.margin_w) +
                          "): the battery would never charge");
    }
  }
  if (table.has("peak_w_max")) return;
  if (table.has("peak_shave")) table.fail("peak_shave", "needs peak_w_max");
}

bool is_same_line(const BatteryLinkSettings& a, const BatteryLinkSettings& b) {
  if (!a.rtu || !b.rtu) return false;
  std::error_code ignored;
  return a.device == b.device.view() ||
         std::filesystem::equivalent(a.device.c_str(), b.device.c_str(), ignored);
}

void load_meter_map(TomlTable& table, const BatteryConfig& battery, std::string_view map_file,
                    std::string_view variant, SiteConfig& site) {
  check_link(table, site.link);
  FixedText<511> path;
  if (!load_linked_map(table, map_file, variant, site.link, site.map, path)) return;
  if (!site.map.is_meter) {
    table.fail("map", "is a battery's map: use a map in meters/, with kind = \"meter\"");
  }
  if (is_same_line(site.link, battery.link)) {
    table.fail("device",
               "is the battery's serial line, which cannot be shared: use another line, or "
               "source = \"battery\" if the battery has a grid power point");
  }
}

void use_grid_point(TomlTable& table, BatteryConfig& battery) {
  if (!table.ok() || measure_grid_power(battery.map)) return;
  table.fail("source", "= \"battery\": the battery's map " + std::string(battery.map.name.view()) +
                           " has no grid power point: use a meter's map");
}

}  // namespace

void read_meter(TomlTable table, BatteryConfig& battery, SiteConfig& site) {
  if (table.value() == nullptr) return;
  SiteSettings& settings = site.settings;
  int source = 0;
  int on_loss = 0;
  FixedText<255> map_file;
  RegisterName variant;
  table.choice("source", source, {"map", "battery"});
  settings.meter = source == 0 ? MeterSource::kMap : MeterSource::kBattery;
  if (settings.meter == MeterSource::kMap) {
    table.require("map");
    table.text("map", map_file);
    table.text("variant", variant);
    read_link(table, site.link);
  }
  read_connection(table, settings.connection);
  table.choice("on_loss", on_loss, {"idle", "ignore"});
  table.boolean("judged", settings.meter_check.judges);
  table.integer("pv_w_max", settings.pv_w_max, 0, kConnectionWMax);
  table.finish();
  settings.idle_without_meter = on_loss == 0;
  check_connection(table, settings.connection);
  if (settings.meter == MeterSource::kMap) {
    load_meter_map(table, battery, map_file.view(), variant.view(), site);
  } else {
    use_grid_point(table, battery);
  }
}

void read_limits(TomlTable table, SiteConfig& site) {
  if (table.value() == nullptr) return;
  FixedText<255> file;
  table.require("file");
  table.text("file", file);
  table.choice("on_timeout", site.settings.idle_after_timeout, {"release_limits", "idle"});
  table.finish();
  if (!table.ok()) return;
  keep_resolved(table, "file", file.view(), site.limit_file);
  site.settings.has_outside_limits = true;
}

namespace {

/// Whole EUR/MWh, as in the proof: 1500 or 1500.0.
void read_threshold(TomlTable& table, std::string_view key, std::int32_t& eur_per_mwh) {
  std::int32_t centi_eur_per_mwh = eur_per_mwh * kCentiPerEur;
  table.scaled(key, centi_eur_per_mwh, kCentiPerEur, -kThresholdMaxEurPerMwh,
               kThresholdMaxEurPerMwh);
  if (centi_eur_per_mwh % kCentiPerEur != 0) {
    table.fail(key, "must be whole EUR/MWh, as the student is proved for");
  }
  eur_per_mwh = centi_eur_per_mwh / kCentiPerEur;
}

/// Full cycles: twelve for a battery that is full in an hour, fewer for a slower one. Correct
/// prices have needed no more.
std::int32_t default_cycles_per_day_e4(std::int32_t power_w, std::int32_t capacity_wh) {
  const std::int64_t cycles_e4 = std::int64_t{120'000} * power_w / capacity_wh;
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(cycles_e4, 10'000, 1'000'000));
}

}  // namespace

void read_guard(TomlTable table, const BatteryConfig& battery, ControlSettings& control) {
  GuardSettings& guard = control.guard;
  read_threshold(table, "low_price_eur_per_mwh", guard.thresholds.low_eur_per_mwh);
  read_threshold(table, "high_price_eur_per_mwh", guard.thresholds.high_eur_per_mwh);
  table.scaled("soc_min", guard.soc_min_e4, 10'000, 0, 1);
  table.scaled("soc_max", guard.soc_max_e4, 10'000, 0, 1);
  table.integer("price_age_s_max", guard.price_age_s_max, 60, 1'800);
  table.integer("stand_in_s_max", guard.stand_in_s_max, 0, 3'600);
  table.integer("frozen_price_s_max", control.frozen_price.stop_s, 0, kSecondsPerDay);
  table.scaled("temperature_min_c", guard.temperature_min_deci_c, 10, -50, 100);
  table.scaled("temperature_max_c", guard.temperature_max_deci_c, 10, -50, 100);
  table.integer("ramp_w_max", guard.ramp_w_max, 0, 100'000'000);
  control.cycles_per_day_max_e4 = default_cycles_per_day_e4(guard.power_w, battery.capacity_wh);
  table.scaled("cycles_per_day_max", control.cycles_per_day_max_e4, 10'000, 0, 100);
  table.integer("reversals_per_hour_max", control.reversals_per_hour_max, 0, kStepsPerHour);
  table.finish();
  if (!guard.thresholds.are_ordered()) {
    table.fail("low_price_eur_per_mwh", "must be below high_price_eur_per_mwh");
  }
  if (guard.soc_min_e4 + 2 * guard.soc_hysteresis_e4 >= guard.soc_max_e4) {
    table.fail("soc_min", "must be below soc_max by more than 0.01");
  }
  if (guard.temperature_min_deci_c >= guard.temperature_max_deci_c) {
    table.fail("temperature_min_c", "must be below temperature_max_c");
  }
}

namespace {

/// "17:00", or "24:00" for the end of the day.
bool parse_time_of_day(std::string_view text, std::int16_t& minute) {
  const int hours = detail::take_digits(text, 2);
  const bool has_colon = detail::take(text, ':');
  const int minutes = detail::take_digits(text, 2);
  if (hours < 0 || !has_colon || minutes < 0 || !text.empty()) return false;
  if (minutes > 59 || hours * 60 + minutes > kMinutesPerDay) return false;
  minute = static_cast<std::int16_t>(hours * 60 + minutes);
  return true;
}

void read_time(TomlTable& table, std::string_view key, std::int16_t& minute) {
  table.require(key);
  const std::string* const text = table.text(key);
  if (text == nullptr || parse_time_of_day(*text, minute)) return;
  table.fail(key, "must be a local time of day such as \"17:00\", at most \"24:00\"");
}

void read_months(TomlTable& table, ReservePeriod& period) {
  const TomlArray* const months = table.array("months");
  if (months == nullptr) return;
  period.months = 0;
  for (const TomlValue& month : *months) {
    const std::int64_t* const number = month.as<std::int64_t>();
    if (number == nullptr || *number < 1 || *number > 12) {
      return table.fail("months", "must be a list of months, 1 to 12");
    }
    period.months |= static_cast<std::uint16_t>(1 << (*number - 1));
  }
  if (period.months == 0) table.fail("months", "is empty: omit it for every month");
}

ReservePeriod read_period(TomlTable table, const GuardSettings& guard) {
  ReservePeriod period;
  std::int32_t soc_e4 = 0;
  read_time(table, "from", period.from_minute);
  read_time(table, "to", period.to_minute);
  table.require("soc");
  table.scaled("soc", soc_e4, 10'000, 0, 1);
  read_months(table, period);
  table.finish();
  if (period.from_minute == period.to_minute) {
    table.fail("to", "equals from: write \"00:00\" to \"24:00\" for a whole day");
  }
  if (soc_e4 + 2 * guard.soc_hysteresis_e4 >= guard.soc_max_e4) {
    table.fail("soc", "must be below [guard] soc_max by more than 0.01");
  }
  period.soc_e4 = static_cast<std::int16_t>(soc_e4);
  return period;
}

}  // namespace

void check_full_charge(TomlTable& battery, const ControlSettings& control) {
  if (control.full_charge_every_days == 0) return;
  if (control.guard.soc_max_e4 >= FullCharge::kFullE4) return;
  battery.fail("full_charge_every_days",
               "needs [guard] soc_max of at least 0.995 for a full charge");
}

void read_reserve(TomlTable& root, ControlSettings& control) {
  const TomlArray* const periods = root.array("reserve");
  if (periods == nullptr) return;
  for (const TomlValue& value : *periods) {
    if (!root.ok()) return;
    if (value.as<TomlMembers>() == nullptr) {
      return root.fail("reserve", "must be tables: [[reserve]] with from, to and soc");
    }
    const ReservePeriod period =
        read_period(TomlTable(&value, root.file(), "[[reserve]]", root.error()), control.guard);
    if (control.reserve.try_push_back(period)) continue;
    return root.fail("reserve", "has more than " + std::to_string(ReservePlan::capacity()) +
                                    " periods: remove some");
  }
}

void read_outlook(TomlTable table, OutlookSettings& outlook) {
  PriceTransportKeys keys;
  read_price_server(table, outlook.http, outlook.fields, keys);
  table.text("file", outlook.file);
  table.finish();
  if (!table.ok() || table.value() == nullptr) return;
  if (table.has("url") && table.has("file")) {
    return table.fail("file", "and url are two sources: remove one");
  }
  if (!outlook.file.empty()) {
    return keep_resolved(table, "file", outlook.file.view(), outlook.file);
  }
  check_price_url(table, "url", outlook.http.url.view(), keys);
  keep_resolved(table, "ca_file", outlook.http.ca_file.view(), outlook.http.ca_file);
  load_headers(table, keys, outlook.http);
}

namespace {

/// Difference of the capacity that a battery reports from the configured one: ageing and rounding.
std::int32_t capacity_tolerance_wh(const BatteryConfig& battery) { return battery.capacity_wh / 4; }

/// The battery must report the configured capacity, else it is another battery.
void expect_capacity(BatteryConfig& battery) {
  for (IdentityCheck& check : battery.map.identity) {
    if (battery.map.points[check.point].name != "capacity") continue;
    check.value_min = battery.capacity_wh - capacity_tolerance_wh(battery);
    check.value_max = battery.capacity_wh + capacity_tolerance_wh(battery);
    check.hint = "check [battery] capacity_wh, or the address: this may be another battery";
  }
}

/// Smaller values are probably in kW or kWh.
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
  table.integer("full_charge_every_days", control.full_charge_every_days, 0, 365);
  table.finish();
  check_link(table, battery.link);
  if (!load_linked_map(table, map_file.view(), variant.view(), battery.link, battery.map,
                       battery.map_path)) {
    return;
  }
  if (battery.map.is_meter) return table.fail("map", "is a meter's map: use it in [meter]");
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
                   " has no watchdog: if bess-edge stops, the battery follows its last order "
                   "without end; choose another variant, or add allow_without_watchdog = true");
  }
}

void set_supervision(const BatteryConfig& battery, ControlSettings& control) {
  SupervisionSettings& supervision = control.supervision;
  supervision.response = {.band = battery.map.response,
                          .power_w = control.guard.power_w,
                          .capacity_wh = battery.capacity_wh};
  supervision.capacity_wh_min = battery.capacity_wh - capacity_tolerance_wh(battery);
  supervision.capacity_wh_max = battery.capacity_wh + capacity_tolerance_wh(battery);
}

FixedText<159> link_place(const BatteryLinkSettings& link) {
  if (link.rtu) return link.device.view();
  return formatted("%s:%d", link.host.c_str(), link.port).c_str();
}

FixedText<159> battery_place(const BatteryConfig& battery) {
  const int unit = battery.link.unit >= 0 ? battery.link.unit : battery.map.unit;
  return formatted("%s unit %d", link_place(battery.link).c_str(), unit).c_str();
}

}  // namespace bess
