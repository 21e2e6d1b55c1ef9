#include "edge/program/find_battery.h"

#include <cstdio>
#include <string_view>

namespace bess {
namespace {

/// "PLACE: what is wrong there".
std::string trouble_at(const EdgeConfig& config, std::string_view what) {
  return std::string(battery_place(config.battery).view()) + ": " + std::string(what);
}

/// What the link's trouble means for this transport.
std::string_view link_text(const EdgeConfig& config, Status status) {
  if (!config.battery.link.rtu || status != Status::kNotConnected) return status_text(status);
  return "the serial line cannot be opened (is device right and plugged in, is this user in the "
         "group dialout?)";
}

}  // namespace

Status identify_battery(const EdgeConfig& config, ModbusBattery& battery, std::string& trouble) {
  IdentityFailure failure;
  Status status = battery.check_identity(failure);
  if (status == Status::kImplausible) {
    const IdentityCheck& check = config.battery.map.identity[failure.check];
    char text[256];
    std::snprintf(text, sizeof text, "%s reads %lld, not %lld to %lld: %s",
                  config.battery.map.points[check.point].name.c_str(),
                  static_cast<long long>(failure.value), static_cast<long long>(check.value_min),
                  static_cast<long long>(check.value_max), check.hint.c_str());
    trouble = trouble_at(config, text);
    return status;
  }
  BatteryMeasurement measurement;
  if (status == Status::kOk) status = battery.read(measurement);
  if (status != Status::kOk) trouble = trouble_at(config, link_text(config, status));
  return status;
}

Status find_battery(const EdgeConfig& config, ModbusBattery& battery, EdgeClock& clock,
                    std::string& trouble) {
  const std::int64_t deadline_ns =
      clock.monotonic_ns() + config.battery.start_timeout_s * kNanosecondsPerSecond;
  while (!clock.stop_requested()) {
    const bool last = clock.monotonic_ns() >= deadline_ns || config.battery.start_without_battery;
    const Status status = identify_battery(config, battery, trouble);
    // The wrong device stays the wrong device.
    if (status == Status::kOk || status == Status::kImplausible || last) return status;
    sleep_until_monotonic(clock.monotonic_ns() + kNanosecondsPerSecond / 5);
  }
  return Status::kOk;
}

bool may_start_without(const EdgeConfig& config, Status status) {
  return status != Status::kImplausible && config.battery.start_without_battery;
}

}  // namespace bess
