#include "edge/core/supervision/response_monitor.h"

#include <algorithm>
#include <numeric>

#include "shared/fixed_point.h"

namespace bess {
namespace {

/// Beyond these the SoC may be recalibrated, or stick to the end.
constexpr std::int32_t kSocEndHighE4 = 9'500;
constexpr std::int32_t kSocEndLowE4 = 1'000;
/// Distance to an end, and error of a correct SoC: beyond it, the energy goes elsewhere.
constexpr std::int64_t kExcusedE4Max = 2'000;

/// Displayed full and empty: an SoC recalibrated beyond them stays constant for a while.
constexpr std::int32_t kShownFullE4 = 9'990;
constexpr std::int32_t kShownEmptyE4 = 10;

constexpr std::int32_t kReadingsUntilSettled = 3;
constexpr std::int32_t kStillReadings = 2;
constexpr std::int64_t kStillSlackE4 = 50;

constexpr std::int64_t kSocErrorE4 = 100;  ///< error of any SoC from one reading to the next
constexpr std::int32_t kUnknownStepE4 = 100;

bool is_high(std::int32_t soc_e4) { return soc_e4 >= kSocEndHighE4; }
bool is_low(std::int32_t soc_e4) { return soc_e4 <= kSocEndLowE4; }

std::int16_t to_int16(std::int64_t value) {
  return static_cast<std::int16_t>(clamp_to<std::int64_t>(value, INT16_MIN, INT16_MAX));
}

}  // namespace

SocMonitor::SocMonitor(const ResponseSettings& settings)
    : settings_(settings), balance_(settings), sparse_soc_(settings) {}

void SocMonitor::observe(const Response& now) {
  const BatteryMeasurement& m = now.measurement;
  capacity_wh_ = m.capacity_wh > 0 ? m.capacity_wh : settings_.capacity_wh;
  shown_step_e4_ = std::gcd(shown_step_e4_, m.soc_e4);
  const std::int64_t seconds = now.steady_s - before_.steady_s;
  if (!has_before_ || seconds <= 0 || seconds > kReadingGapMaxS) return reset_from(now);
  if (sparse_soc_.is_seldom()) {
    sparse_soc_.note_power(now, flow_power_w_);
    sparse_soc_.observe(now);
  }
  const Flow flow = flow_until(now);
  const std::int64_t change_e4 = m.soc_e4 - before_.measurement.soc_e4;
  const bool excused = is_excused(now, flow, change_e4);
  if (!excused && judge_jump(now, flow, change_e4)) return reset_from(now);
  if (unsettled_readings_ > 0) --unsettled_readings_;
  if (sparse_soc_.is_seldom()) {
    check_sparse_soc(now, excused);
  } else {
    judge_standstill(now, flow, excused);
    EnergyInterval interval = interval_of(now, flow);
    if (excused) interval.kind = EnergyInterval::Kind::kUnknown;
    judge_balance(interval);
  }
  before_ = now;
  note_power(now);
  measured_energy_ws_ = late_ws_ = 0;
}

void SocMonitor::judge_balance(const EnergyInterval& interval) {
  balance_.observe(interval, soc_span_e4());
  contradicts_ = contradicts_ || balance_.findings().contradicts;
}

void SocMonitor::note_cut(const Response& now) {
  if (sparse_soc_.is_seldom()) sparse_soc_.note_power(now, flow_power_w_);
  note_power(now);
}

void SocMonitor::note_power(const Response& now) {
  measured_energy_ws_ += measured_energy_ws(now, 0);
  late_ws_ += late_ws(now);
  flow_s_ = now.steady_s;
  flow_power_w_ = now.measurement.power_w;
}

void SocMonitor::reset_from(const Response& now) {
  has_before_ = true;
  before_ = now;
  flow_s_ = now.steady_s;
  flow_power_w_ = now.measurement.power_w;
  measured_energy_ws_ = late_ws_ = 0;
  still_e4_ = still_least_e4_ = still_most_e4_ = still_total_e4_ = 0;
  still_readings_ = 0;
  balance_.interrupt();
  sparse_soc_.begin(now);
}

/// The reading's own power since its order, the previous reading's power until then.
std::int64_t SocMonitor::measured_energy_ws(const Response& now, std::int64_t delay_s) const {
  const std::int64_t seconds = std::max<std::int64_t>(now.steady_s - flow_s_, 0);
  const std::int64_t of_order_s = std::clamp<std::int64_t>(now.order_age_s - delay_s, 0, seconds);
  return std::int64_t{now.measurement.power_w} * of_order_s +
         std::int64_t{flow_power_w_} * (seconds - of_order_s);
}

/// As if power lagged by the map's settling time and the SoC by its refresh time. Power that has
/// not reached its order is assumed to ramp all the time.
std::int64_t SocMonitor::late_ws(const Response& now) const {
  const std::int64_t late_ws =
      measured_energy_ws(now, settings_.band.settle_s + settings_.band.soc_refresh_s);
  const std::int32_t power_w = now.measurement.power_w;
  const std::int64_t apart_w = std::int64_t{power_w} - now.ordered_power_w;
  if (std::abs(apart_w) <= settings_.tolerance_w(now.ordered_power_w)) return late_ws;
  const std::int64_t seconds = std::max<std::int64_t>(now.steady_s - flow_s_, 0);
  const std::int64_t ramp_ws = (std::int64_t{power_w} + flow_power_w_) * seconds / 2;
  return power_w > 0 ? std::min(late_ws, ramp_ws) : std::max(late_ws, ramp_ws);
}

std::int64_t SocMonitor::e4_of(std::int64_t energy_ws) const {
  return energy_ws * 10'000 / (3'600 * capacity_wh_);
}

SocMonitor::Flow SocMonitor::flow_until(const Response& now) const {
  const std::int64_t energy_e4 = e4_of(measured_energy_ws_ + measured_energy_ws(now, 0));
  if (sparse_soc_.is_seldom()) {
    const EnergyRange change = sparse_soc_.change();
    const std::int64_t least_e4 = e4_of(change.least_ws);
    const std::int64_t most_e4 = e4_of(change.most_ws);
    return {energy_e4, e4_of(change.surely_ws()), std::min(least_e4 * 3 / 5, least_e4 * 7 / 5),
            std::max(most_e4 * 3 / 5, most_e4 * 7 / 5)};
  }
  const std::int64_t late_e4 = e4_of(late_ws_ + late_ws(now));
  // Bounds include losses, ageing and a rounded capacity.
  const auto [least_e4, most_e4] =
      std::minmax({energy_e4 * 3 / 5, energy_e4 * 7 / 5, late_e4 * 3 / 5, late_e4 * 7 / 5});
  return {energy_e4, late_e4, least_e4, most_e4};
}

/// Rest as ordered.
bool SocMonitor::rests(const Response& reading) const {
  const std::int32_t noise_w = settings_.noise_w();
  return reading.is_driven && power_magnitude_w(reading.ordered_power_w) <= noise_w &&
         power_magnitude_w(reading.measurement.power_w) <= 2 * noise_w;
}

/// Resolution from the map or as observed: a register of 0.1 % may count in whole percents.
std::int32_t SocMonitor::soc_step_e4() const {
  const std::int32_t shown_e4 = shown_step_e4_ > 0 ? shown_step_e4_ : kUnknownStepE4;
  return std::max(settings_.band.soc_step_e4, std::min(shown_e4, kUnknownStepE4));
}

/// A sparse SoC lags by the energy since its refresh.
std::int32_t SocMonitor::soc_span_e4() const {
  const std::int64_t lag_s = settings_.band.soc_refresh_s - SparseSocCheck::kUsualRefreshS;
  const std::int64_t lag_ws = std::int64_t{settings_.power_w} * std::max<std::int64_t>(lag_s, 0);
  return soc_step_e4() + static_cast<std::int32_t>(e4_of(lag_ws));
}

/// Charging at the upper end and discharging at the lower: it may stay constant, or jump.
bool SocMonitor::is_excused(const Response& now, const Flow& flow, std::int64_t change_e4) {
  const std::int32_t before_e4 = before_.measurement.soc_e4;
  const std::int32_t soc_e4 = now.measurement.soc_e4;
  const bool high = is_high(soc_e4) || is_high(before_e4);
  const bool low = is_low(soc_e4) || is_low(before_e4);
  if (!high && !low) excused_e4_ = 0;
  if (is_beyond_its_end(soc_e4, flow, change_e4)) return true;
  const bool charges = flow.energy_e4 > 0;
  const bool clings =
      (high && charges && change_e4 >= 0) || (low && flow.energy_e4 < 0 && change_e4 <= 0);
  if (!clings) return false;
  const std::int64_t shown_e4 = charges ? change_e4 : -change_e4;
  const std::int64_t due_e4 = charges ? flow.least_e4 : -flow.most_e4;
  excused_e4_ += std::max<std::int64_t>(due_e4 - shown_e4, 0);
  return excused_e4_ <= kExcusedE4Max;
}

bool SocMonitor::is_beyond_its_end(std::int32_t soc_e4, const Flow& flow, std::int64_t change_e4) {
  const bool is_saturated = soc_e4 >= kShownFullE4 || soc_e4 <= kShownEmptyE4;
  if (change_e4 != 0 || !is_saturated || beyond_end_e4_ <= 0) return false;
  beyond_end_e4_ -= std::abs(flow.energy_e4);
  return true;
}

bool SocMonitor::judge_jump(const Response& now, const Flow& flow, std::int64_t change_e4) {
  const std::int64_t seconds = now.steady_s - before_.steady_s;
  const bool is_at_rest = rests(now) && rests(before_) && now.order_age_s >= seconds;
  const std::int64_t full_step_e4 = e4_of(std::int64_t{settings_.power_w} * seconds);
  const std::int64_t slack_e4 =
      kSocErrorE4 + soc_step_e4() * 3 / 2 + (is_at_rest ? 0 : 2 * full_step_e4);
  const bool jumps = change_e4 < flow.least_e4 - slack_e4 || change_e4 > flow.most_e4 + slack_e4;
  const bool was_driven = now.is_driven && before_.is_driven && !is_at_rest;
  if (!jumps) {
    if (was_driven) jumps_.good();
    return false;
  }
  // A jump and its return are one jump.
  if (was_driven && unsettled_readings_ == 0) jumps_.bad();
  unsettled_readings_ = kReadingsUntilSettled;
  beyond_end_e4_ = std::abs(change_e4);
  contradicts_ = contradicts_ || jumps_.is_found();
  return true;
}

EnergyInterval SocMonitor::interval_of(const Response& now, const Flow& flow) const {
  using Kind = EnergyInterval::Kind;
  const std::int64_t seconds = now.steady_s - before_.steady_s;
  const std::int32_t noise_w = settings_.noise_w();
  const std::int64_t flowing_e4 = e4_of(4 * std::int64_t{noise_w} * seconds);
  // In the battery's own mode the power changes between readings.
  const bool is_known = now.is_driven && before_.is_driven;
  const bool is_at_rest = rests(now) && rests(before_) && now.order_age_s >= seconds;
  const bool flows = std::abs(flow.energy_e4) >= flowing_e4;
  return {.kind = !is_known    ? Kind::kUnknown
                  : is_at_rest ? Kind::kResting
                  : flows      ? Kind::kFlowing
                               : Kind::kUnknown,
          .energy_e4 = to_int16(flow.energy_e4),
          .late_energy_e4 = to_int16(flow.late_energy_e4),
          .soc_e4 = to_int16(now.measurement.soc_e4 - before_.measurement.soc_e4),
          .seconds = to_int16(seconds),
          .power_w = now.measurement.power_w};
}

/// Minimum energy over all delays and meter errors; none if it may have either sign.
std::int64_t SocMonitor::surely_moved_e4(const Flow& flow, std::int64_t seconds) const {
  if ((flow.energy_e4 < 0) != (flow.late_energy_e4 < 0)) return 0;
  const std::int64_t measured_e4 =
      std::min(std::abs(flow.energy_e4), std::abs(flow.late_energy_e4));
  const std::int64_t error_e4 = e4_of(settings_.noise_w() * seconds);
  const std::int64_t sure_e4 = std::max<std::int64_t>(measured_e4 - error_e4, 0);
  return flow.energy_e4 < 0 ? -sure_e4 : sure_e4;
}

/// The SoC may flicker by a step: it must have moved further.
std::int64_t SocMonitor::must_show_e4() const { return soc_step_e4() * 6 / 5 + kStillSlackE4; }

/// Judges readings once enough of them are combined.
void SocMonitor::check_sparse_soc(const Response& now, bool excused) {
  using Kind = EnergyInterval::Kind;
  const bool is_known = now.is_driven && before_.is_driven;
  if (!is_known || excused) {
    sparse_soc_.restart_interval();
    sparse_soc_.restart_standstill();
    return judge_balance({});
  }
  const std::int64_t error_e4 = e4_of(settings_.noise_w() * sparse_soc_.still_s());
  const std::int64_t moved_e4 = (std::abs(e4_of(sparse_soc_.still_ws())) - error_e4) * 7 / 8;
  if (sparse_soc_.still_readings() >= kStillReadings && moved_e4 > must_show_e4())
    contradicts_ = true;
  EnergyInterval interval = interval_of(now, flow_until(now));
  if (interval.kind == Kind::kResting && now.order_age_s >= settings_.band.soc_refresh_s) {
    sparse_soc_.restart_interval();
    return judge_balance(interval);
  }
  SparseSocCheck::Interval together;
  if (sparse_soc_.take_interval(together)) {
    return judge_balance({.kind = Kind::kFlowing,
                          .energy_e4 = to_int16(e4_of(together.energy_ws)),
                          .late_energy_e4 = to_int16(e4_of(together.surely_ws)),
                          .soc_e4 = to_int16(together.soc_e4),
                          .seconds = to_int16(together.seconds),
                          .power_w = now.measurement.power_w});
  }
  if (!sparse_soc_.is_too_long()) return;
  sparse_soc_.restart_interval();
  judge_balance({});
}

void SocMonitor::judge_standstill(const Response& now, const Flow& flow, bool excused) {
  const std::int32_t soc_e4 = now.measurement.soc_e4;
  const bool is_known = now.is_driven && before_.is_driven;
  if (!is_known || soc_e4 != before_.measurement.soc_e4) {
    still_e4_ = still_least_e4_ = still_most_e4_ = still_total_e4_ = 0;
    still_readings_ = 0;
    return;
  }
  const std::int64_t moved_e4 =
      excused ? 0 : surely_moved_e4(flow, now.steady_s - before_.steady_s);
  still_e4_ += moved_e4;
  still_total_e4_ += std::abs(moved_e4);
  still_least_e4_ = std::min(still_least_e4_, still_e4_);
  still_most_e4_ = std::max(still_most_e4_, still_e4_);
  ++still_readings_;
  const std::int64_t must_show_e4 = this->must_show_e4();
  const std::int64_t range_e4 = (still_most_e4_ - still_least_e4_) * 7 / 8;
  // Alternation returns to the start, but not without a step in either direction.
  const std::int64_t total_e4 = still_total_e4_ * 7 / 8;
  const bool moved = range_e4 > must_show_e4 || total_e4 > 2 * must_show_e4;
  if (still_readings_ >= kStillReadings && moved) contradicts_ = true;
}

}  // namespace bess
