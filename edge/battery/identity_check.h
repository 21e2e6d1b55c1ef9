// Is this the device that the register map describes? Its SunSpec models are looked for, then the
// map's identity points are read. Before all of them fit, nothing is measured and nothing is
// written.
#pragma once

#include <cstdint>

#include "edge/battery/battery_bus.h"

namespace bess {

struct IdentityFailure {
  int check = 0;  ///< index into RegisterMap::identity
  std::int64_t value = 0;
};

template <typename Link, typename Time>
Status check_identity_point(const RegisterMap& map, BatteryBus<Link, Time>& bus,
                            const IdentityCheck& check, std::int64_t& value) {
  const RegisterPoint& point = map.points[check.point];
  std::uint16_t registers[kTextRegistersMax] = {};
  Status status = retried([&] { return bus.read_point(check.point, registers); });
  if (status != Status::kOk) return status;
  if (point.type == RegisterType::kText) {
    const bool same = decode_text(point, registers).view().starts_with(check.text.view());
    return same ? Status::kOk : Status::kImplausible;
  }
  if (check.may_be_unknown && is_not_implemented(point, registers)) return Status::kOk;
  if (point.scale_from >= 0 || point.percent_of >= 0) {
    status = retried([&] { return bus.read_due(); });
    if (status != Status::kOk) return status;
  }
  LivePoints now = bus.live();
  now.keep(map, check.point, registers);
  const bool plausible = live_value(map, now, check.point, value) && value >= check.value_min &&
                         value <= check.value_max;
  return plausible ? Status::kOk : Status::kImplausible;
}

/// kImplausible: another device; `failure` says which check and what was read.
template <typename Link, typename Time>
Status check_identity_of(const RegisterMap& map, BatteryBus<Link, Time>& bus,
                         IdentityFailure& failure) {
  failure = IdentityFailure{};
  const Status located = retried([&] { return bus.locate_models(); });
  if (located != Status::kOk) return located;
  for (; failure.check < map.identity.size(); ++failure.check) {
    const IdentityCheck& check = map.identity[failure.check];
    const Status status = check_identity_point(map, bus, check, failure.value);
    if (status != Status::kOk) return status;
  }
  return Status::kOk;
}

}  // namespace bess
