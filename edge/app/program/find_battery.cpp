#include "edge/app/program/find_battery.h"

#include <pthread.h>

#include <string_view>
#include <utility>

#include "edge/app/program/startup.h"
#include "edge/core/base/check.h"
#include "edge/core/memory/heap_seal.h"
#include "edge/records/log/journal.h"
#include "shared/host/text.h"

namespace bess {

namespace {

ModbusBattery* battery_of_check_handler = nullptr;
pthread_t control_thread;

/// Not from another thread, which would interleave with requests of the control thread (the
/// watchdog ends the order then), and not twice, because the release itself may have failed.
void release_after_failed_check(const char*, const char*, int) {
  ModbusBattery* const battery = std::exchange(battery_of_check_handler, nullptr);
  if (battery == nullptr || pthread_equal(pthread_self(), control_thread) == 0) return;
  static_cast<void>(battery->order({.duration_s = 60}));
  static_cast<void>(battery->release());
}

}  // namespace

void release_if_a_check_fails(ModbusBattery& battery) {
  battery_of_check_handler = &battery;
  control_thread = pthread_self();
  check_handler() = release_after_failed_check;
}

bool DeviceSession::begin(const EdgeConfig& config) {
  if (!check_student() || !prepare_memory()) return false;
  FileMessage error;
  if (!lock_battery(config, locks, error)) {
    report(JournalLevel::kError, "%s", error.c_str());
    return false;
  }
  prepare_process();
  clock.emplace(config.clock);
  return true;
}

namespace {

/// "ADDRESS: error".
std::string trouble_at(const EdgeConfig& config, std::string_view what) {
  return std::string(battery_place(config.battery).view()) + ": " + std::string(what);
}

/// Text of a link error for this transport.
std::string_view link_text(const EdgeConfig& config, Status status) {
  if (!config.battery.link.rtu || status != Status::kNotConnected) return status_text(status);
  return "the serial line cannot be opened: check that device is correct and plugged in, and that "
         "this user is in group dialout";
}

std::string missing_model_text(const RegisterMap& map, int model) {
  std::string bases;
  for (const std::uint16_t base : map.model_bases) {
    bases += (bases.empty() ? "" : ", ") + std::to_string(base);
  }
  return formatted(
      "SunSpec model %d not found from %s: check that the device matches map %s and has started",
      model, bases.c_str(), map.name.c_str());
}

std::string raw_text(const RegisterPoint& point, const std::uint16_t* raw) {
  std::string text;
  for (int i = 0; i < point.registers; ++i) {
    text += formatted(i == 0 ? "0x%04X" : " 0x%04X", raw[i]);
  }
  return text;
}

}  // namespace

std::string identity_text(const RegisterMap& map, const IdentityFailure& failure) {
  if (failure.missing_model != 0) return missing_model_text(map, failure.missing_model);
  const IdentityCheck& check = map.identity[failure.check];
  const RegisterPoint& point = map.points[check.point];
  const std::string read = raw_text(point, failure.raw);
  if (point.type == RegisterType::kText) {
    return formatted("%s (register %d) does not begin with \"%s\": %s", point.name.c_str(),
                     point.address, check.text.c_str(), check.hint.c_str());
  }
  const std::string value =
      failure.is_known ? std::to_string(failure.value) : std::string("no plausible value");
  return formatted("%s (register %d, raw %s) is %s, expected %lld to %lld: %s", point.name.c_str(),
                   point.address, read.c_str(), value.c_str(),
                   static_cast<long long>(check.value_min), static_cast<long long>(check.value_max),
                   check.hint.c_str());
}

std::string reading_text(const EdgeConfig& config, ModbusBattery& battery, Status status,
                         int lost_point) {
  const RegisterMap& map = config.battery.map;
  std::string text(link_text(config, status));
  if (const int unit = battery.link().foreign_unit(); unit >= 0) {
    text = formatted("unit %d answered instead of unit %d: set [battery] unit or units", unit,
                     battery.link().asked_unit());
  }
  if (lost_point == 0 || lost_point > map.points.size()) return text;
  const RegisterPoint& point = map.points[lost_point - 1];
  text += formatted(": %s (register %d", point.name.c_str(), point.address);
  if (status != Status::kImplausible) return text + ")";
  return text + formatted(", raw %s), expected %lld to %lld",
                          raw_text(point, battery.live().raw[lost_point - 1]).c_str(),
                          static_cast<long long>(point.value_min),
                          static_cast<long long>(point.value_max));
}

std::string measured_text(const RegisterMap& map, const PointValues& live) {
  std::string text;
  bool is_listed[kPointsMax] = {};
  const auto add_point = [&](std::int8_t point) {
    if (point < 0 || is_listed[point] || !live.known[point]) return;
    is_listed[point] = true;
    const RegisterPoint& p = map.points[point];
    text += formatted("%s%s (register %d) raw %s", text.empty() ? "" : ", ", p.name.c_str(),
                      p.address, raw_text(p, live.raw[point]).c_str());
  };
  for (const PowerCase& c : map.measured_power) {
    add_point(c.when.point);
    for (const PowerCase::Term& term : c.terms) add_point(term.point);
  }
  for (const char* const name : {"soc", "charge_power_max", "discharge_power_max"}) {
    add_point(static_cast<std::int8_t>(find_point(map, name)));
  }
  for (const Condition& c : map.active) add_point(c.point);
  for (const Condition& alarm : map.alarms) {
    std::int64_t value = 0;
    if (live_value(map, live, alarm.point, value) && alarm.holds(value)) add_point(alarm.point);
  }
  add_point(map.off_grid.point);
  return text;
}

BatterySearch identify_battery(const EdgeConfig& config, ModbusBattery& battery) {
  const RegisterMap& map = config.battery.map;
  IdentityFailure failure;
  BatterySearch found;
  found.status = battery.check_identity(failure);
  if (found.status == Status::kImplausible) {
    found.is_stranger = !failure.is_blank(map);
    found.trouble = trouble_at(config, identity_text(map, failure));
    return found;
  }
  BatteryMeasurement m;
  if (found.status == Status::kOk) found.status = battery.read(m);
  if (found.status != Status::kOk) {
    found.trouble = trouble_at(config, reading_text(config, battery, found.status, m.lost_point));
  }
  return found;
}

BatterySearch find_battery(const EdgeConfig& config, ModbusBattery& battery, EdgeClock& clock) {
  const std::int64_t deadline_ns =
      clock.monotonic_ns() + config.battery.start_timeout_s * kNanosecondsPerSecond;
  while (!clock.stop_requested()) {
    const bool last = clock.monotonic_ns() >= deadline_ns;
    BatterySearch found = identify_battery(config, battery);
    if (found.status == Status::kOk || found.is_stranger || last) return found;
    sleep_until_monotonic(clock.monotonic_ns() + kNanosecondsPerSecond / 5);
  }
  return {};
}

}  // namespace bess
