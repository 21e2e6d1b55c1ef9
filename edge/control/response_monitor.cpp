#include "edge/control/response_monitor.h"

#include <algorithm>

#include "shared/units_and_limits.h"

namespace bess {
namespace {

/// INT32_MIN, which a device may send, has no opposite.
constexpr std::int32_t opposite(std::int32_t power_w) { return -std::max(power_w, -INT32_MAX); }

constexpr std::int32_t magnitude(std::int32_t power_w) {
  return power_w < 0 ? opposite(power_w) : power_w;
}

/// From here to full, and this much above the floor of the orders, a battery may slow down.
constexpr std::int32_t kSlowFromE4 = 8'000;
constexpr std::int32_t kSlowAboveFloorE4 = 2'000;
/// Beyond these its count of its charge is set right, or clings to the end.
constexpr std::int32_t kSocEndHighE4 = 9'500;
constexpr std::int32_t kSocEndLowE4 = 1'000;
/// Below this, in 0.1 degC, charging is slowed down or refused.
constexpr std::int32_t kColdDeciC = 80;

constexpr std::int64_t kReadingGapMaxS = 300;  ///< beyond: what flowed between is not known

constexpr std::int64_t kSocErrorE4 = 200;  ///< of any battery's count of its charge
constexpr std::int64_t kJumpE4 = 500;      ///< on top of what power explains
constexpr std::int32_t kReadingsUntilSettled = 3;
constexpr std::int32_t kSumReadingsMax = 15;  ///< half an hour: slow drift is no fault

}  // namespace

void ResponseMonitor::observe(const Response& now) {
  judge_soc(now);
  judge_power(now);
  has_before_ = true;
  before_ = now;
  note_power(now);
  flowed_ws_ = 0;
}

void ResponseMonitor::forget() { *this = ResponseMonitor(settings_); }

/// Also 2.5 % of the rating: a large battery's pumps and fans.
std::int32_t ResponseMonitor::noise_w() const {
  return std::max(settings_.band.tolerance_w, settings_.power_w / 40);
}

std::int32_t ResponseMonitor::tolerance_w(std::int32_t power_w) const {
  const std::int64_t share_w =
      std::int64_t{magnitude(power_w)} * settings_.band.tolerance_percent / 100;
  return std::max(noise_w(), static_cast<std::int32_t>(share_w));
}

void ResponseMonitor::count(std::int32_t& readings, Reason reason) {
  if (++readings >= kReadingsToFind && trip_ == Reason::kStudent) trip_ = reason;
}

void ResponseMonitor::judge_power(const Response& now) {
  answers_ = false;
  if (!now.is_driven || now.order_age_s < settings_.band.settle_s) return;
  if (magnitude(now.ordered_power_w) <= noise_w()) return judge_idle(now.measurement.power_w);
  judge_driven(now);
}

void ResponseMonitor::judge_idle(std::int32_t measured_w) {
  unanswered_orders_ = 0;
  const bool charges = measured_w > 0 && settings_.band.charges_by_itself;
  if (magnitude(measured_w) <= 2 * noise_w() || charges) {
    excessive_idle_ = 0;
  } else {
    count(excessive_idle_, Reason::kUncontrolledPower);
  }
}

void ResponseMonitor::judge_driven(const Response& now) {
  const std::int32_t ordered_w = magnitude(now.ordered_power_w);
  const bool is_charging = now.ordered_power_w > 0;
  const std::int32_t measured_w =  // positive: as ordered
      is_charging ? now.measurement.power_w : opposite(now.measurement.power_w);
  // The sun may outdo an order to discharge: that proves nothing.
  if (!is_charging && measured_w < 0 && settings_.band.charges_by_itself) return;
  if (measured_w < -noise_w()) return count(opposed_, Reason::kWrongDirection);
  const bool is_pv = is_charging && settings_.band.charges_by_itself;
  if (measured_w - ordered_w > tolerance_w(ordered_w) && !is_pv) {
    return count(excessive_driven_, Reason::kUncontrolledPower);
  }
  excessive_driven_ = 0;
  answers_ = measured_w > std::max(noise_w(), ordered_w / 10);
  unanswered_orders_ = answers_ ? 0 : unanswered_orders_ + 1;
  if (answers_) opposed_ = unexplained_ = 0;
  const std::int32_t wanted_w = reachable_power_w(now);
  const bool is_weak = measured_w < wanted_w - tolerance_w(wanted_w) && wanted_w > 2 * noise_w() &&
                       !may_be_less(now);
  if (is_weak && !answers_) ++unexplained_;
  weak_answers_ = is_weak ? weak_answers_ + 1 : 0;
}

/// Of the order, what the device's own limits let through.
std::int32_t ResponseMonitor::reachable_power_w(const Response& now) const {
  const BatteryMeasurement& m = now.measurement;
  const std::int32_t limit_w = now.ordered_power_w > 0 ? m.charge_w_max : m.discharge_w_max;
  return std::min(magnitude(now.ordered_power_w), std::max(limit_w, 0));
}

bool ResponseMonitor::may_be_less(const Response& now) const {
  const BatteryMeasurement& m = now.measurement;
  const bool is_charging = now.ordered_power_w > 0;
  if (is_charging && m.temperature_min_deci_c < kColdDeciC) return true;
  return is_charging ? m.soc_e4 >= kSlowFromE4 : m.soc_e4 <= now.soc_floor_e4 + kSlowAboveFloorE4;
}

void ResponseMonitor::note_power(const Response& now) {
  flowed_ws_ += flowed_ws(now);
  flow_utc_s_ = now.utc_s;
  flow_power_w_ = now.measurement.power_w;
}

/// The reading's own power since its order, the power of the reading before until then.
std::int64_t ResponseMonitor::flowed_ws(const Response& now) const {
  const std::int64_t seconds = std::max<std::int64_t>(now.utc_s - flow_utc_s_, 0);
  const std::int64_t of_order_s = std::clamp<std::int64_t>(now.order_age_s, 0, seconds);
  return std::int64_t{now.measurement.power_w} * of_order_s +
         std::int64_t{flow_power_w_} * (seconds - of_order_s);
}

void ResponseMonitor::judge_soc(const Response& now) {
  const std::int32_t soc_e4 = now.measurement.soc_e4;
  const std::int64_t seconds = now.utc_s - before_.utc_s;
  if (!has_before_ || seconds <= 0 || seconds > kReadingGapMaxS) return begin_sum(soc_e4);
  const std::int64_t capacity_wh =
      now.measurement.capacity_wh > 0 ? now.measurement.capacity_wh : settings_.capacity_wh;
  const std::int64_t moved = (flowed_ws_ + flowed_ws(now)) * 10'000 / (3'600 * capacity_wh);
  // Losses, ageing and a rounded capacity are all within these bounds.
  const SocRange range{std::min(moved * 3 / 5, moved * 7 / 5),
                       std::max(moved * 3 / 5, moved * 7 / 5)};
  const std::int64_t full_step_e4 =
      std::int64_t{settings_.power_w} * seconds * 10'000 / (3'600 * capacity_wh);
  const std::int64_t slack_e4 = kSocErrorE4 + settings_.band.soc_step_e4 + full_step_e4;

  const std::int64_t change_e4 = soc_e4 - before_.measurement.soc_e4;
  const bool jumps = change_e4 < range.least_e4 - slack_e4 - kJumpE4 ||
                     change_e4 > range.most_e4 + slack_e4 + kJumpE4;
  if (jumps) {
    unsettled_readings_ = kReadingsUntilSettled;
    return begin_sum(soc_e4);
  }
  if (unsettled_readings_ > 0) --unsettled_readings_;
  // In its own mode the power changes between the readings.
  const bool is_known = now.is_driven && before_.is_driven;
  const bool is_at_an_end = soc_e4 >= kSocEndHighE4 || soc_e4 <= kSocEndLowE4;
  if (!is_known || is_at_an_end) return begin_sum(soc_e4);
  judge_standstill(soc_e4, moved);
  judge_sum(soc_e4, range, slack_e4);
}

void ResponseMonitor::judge_standstill(std::int32_t soc_e4, std::int64_t moved_e4) {
  if (soc_e4 != before_.measurement.soc_e4) {
    return begin_standstill();
  }
  still_e4_ += moved_e4;
  still_range_.least_e4 = std::min(still_range_.least_e4, still_e4_);
  still_range_.most_e4 = std::max(still_range_.most_e4, still_e4_);
  ++still_readings_;
  const std::int64_t must_show_e4 = settings_.band.soc_step_e4 * 6 / 5 + 50;
  const std::int64_t moved_at_least_e4 = (still_range_.most_e4 - still_range_.least_e4) * 3 / 4;
  const bool stands_still = still_readings_ >= kReadingsToFind && moved_at_least_e4 > must_show_e4;
  if (stands_still && trip_ == Reason::kStudent) trip_ = Reason::kSocMismatch;
}

void ResponseMonitor::judge_sum(std::int32_t soc_e4, const SocRange& range, std::int64_t slack_e4) {
  sum_.least_e4 += range.least_e4;
  sum_.most_e4 += range.most_e4;
  const std::int64_t change_e4 = soc_e4 - sum_soc_e4_;
  if (change_e4 < sum_.least_e4 - slack_e4 || change_e4 > sum_.most_e4 + slack_e4) {
    count(sum_apart_, Reason::kSocMismatch);
  } else {
    sum_apart_ = 0;
    if (++sum_readings_ >= kSumReadingsMax) begin_sum(soc_e4);
  }
}

void ResponseMonitor::begin_standstill() {
  still_range_ = SocRange{};
  still_e4_ = still_readings_ = 0;
}

void ResponseMonitor::begin_sum(std::int32_t soc_e4) {
  begin_standstill();
  sum_soc_e4_ = soc_e4;
  sum_ = SocRange{};
  sum_readings_ = sum_apart_ = 0;
}

}  // namespace bess
