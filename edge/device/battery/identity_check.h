// Identity check: the device matches the register map. Locates its SunSpec models and reads the
// map's identity points. Nothing is measured or written until all of them match. Then it determines
// the optional points of the device.
#pragma once

#include <algorithm>
#include <cstdint>

#include "edge/device/battery/battery_bus.h"

namespace bess {

struct IdentityFailure {
  int check = 0;                    ///< index into RegisterMap::identity, if no model is missing
  std::uint16_t missing_model = 0;  ///< SunSpec model; 0: all required models found
  bool is_known = false;            ///< `value` could be decoded
  std::int64_t value = 0;
  std::uint16_t raw[kTextRegistersMax] = {};

  /// True for a device that is still starting: all zeros or all ones, or no models yet.
  [[nodiscard]] bool is_blank(const RegisterMap& map) const {
    if (missing_model != 0) return true;
    const int count = map.points[map.identity[check].point].registers;
    const auto all = [&](int word) { return std::count(raw, raw + count, word) == count; };
    return all(0) || all(0xFFFF);
  }
};

template <typename Link, typename Time>
Status check_identity_point(const RegisterMap& map, BatteryBus<Link, Time>& bus,
                            const IdentityCheck& check, IdentityFailure& failure) {
  const RegisterPoint& point = map.points[check.point];
  const std::uint16_t* const raw = failure.raw;
  Status status = retried(bus.time(), 0, [&] { return bus.read_point(check.point, failure.raw); });
  if (status != Status::kOk) return status;
  if (point.type == RegisterType::kText) {
    const bool same = decode_text(point, raw).view().starts_with(check.text.view());
    return same ? Status::kOk : Status::kImplausible;
  }
  if (check.may_be_unknown && is_not_implemented(point, raw)) return Status::kOk;
  if (point.scale_from >= 0 || point.percent_of >= 0) {
    status = retried(bus.time(), 0, [&] { return bus.read_due(); });
    if (bus.live().failed[point.scale_from < 0 ? point.percent_of : point.scale_from])
      return status;
  }
  PointValues now = bus.live();
  now.keep(map, check.point, raw);
  failure.is_known = live_value(map, now, check.point, failure.value);
  const bool is_right =
      failure.is_known && failure.value >= check.value_min && failure.value <= check.value_max;
  return is_right ? Status::kOk : Status::kImplausible;
}

/// kImplausible: another device, or one that is not ready; `failure` has the value read.
template <typename Link, typename Time>
Status check_identity_of(const RegisterMap& map, BatteryBus<Link, Time>& bus,
                         IdentityFailure& failure) {
  failure = IdentityFailure{};
  const Status located =
      retried(bus.time(), 0, [&] { return bus.locate_models(failure.missing_model); });
  if (located != Status::kOk) return located;
  for (int i = 0; i < map.identity.size(); ++i) {
    failure = IdentityFailure{.check = i};
    const Status status = check_identity_point(map, bus, map.identity[i], failure);
    if (status != Status::kOk) return status;
  }
  return bus.find_optional_points();
}

}  // namespace bess
