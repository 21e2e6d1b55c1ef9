#include "tools/hil_runner/virtual/virtual_operator.h"

#include "tools/hil_runner/scenario/edge_settings.h"

namespace bess {

void VirtualOperator::act(const ScenarioEvent& event, std::int64_t now_utc_s, const Trip& trip) {
  using enum ScenarioEvent::Does;
  switch (event.does) {
    case kHold:
      return holds_.publish({.power_w = event.power_w,
                             .until_utc_s = static_cast<std::uint32_t>(now_utc_s + event.for_s)});
    case kHoldRelease:
      return holds_.publish({});
    case kLimit:
    case kLimitTorn:
      limit_ = limit_line(event, now_utc_s);
      return;
    case kLimitClear:
      limit_.clear();
      return;
    case kClear:
      if (trip.is_set()) cleared_.add(trip.utc_s);
      return;
    default:
      return;
  }
}

Status VirtualOperator::read(OutsideLimit& limit, bool& is_set) const {
  is_set = false;
  if (limit_.empty()) return Status::kOk;
  const Status status = parse_outside_limit(limit_, limit);
  is_set = status == Status::kOk;
  return status;
}

}  // namespace bess
