#include "edge/app/recording/energy_evidence.h"

#include <cmath>
#include <cstdlib>

#include "shared/scaled_clock.h"

namespace bess {

namespace {

constexpr int kReadingsMin = 5;  ///< of a step, to distinguish ramp and lag

int last_term(const StaticVector<PowerCase, 4>& cases) {
  for (const PowerCase& c : cases) {
    if (!c.terms.empty()) return c.terms[c.terms.size() - 1].point;
  }
  return -1;
}

}  // namespace

RecordedSteps::RecordedSteps(const RegisterMap& map, std::int32_t unit, std::int32_t time_scale)
    : map_(map),
      places_(map, unit),
      time_scale_(time_scale),
      power_(last_term(map.measured_power)) {}

void RecordedSteps::add(const BusExchange& exchange) {
  places_.follow(exchange);
  if (exchange.outcome != BusOutcome::kAnswered) return;
  bool has_power = false;
  for (int i = 0; i < map_.points.size(); ++i) {
    const int offset = places_.offset_in(exchange, i);
    if (offset < 0 || map_.points[i].type == RegisterType::kText) continue;
    live_.keep(map_, i, exchange.registers.data() + offset);
    has_power |= i == power_;
  }
  const std::int64_t end_ns = exchange.utc_ns + exchange.latency_us * 1'000 * time_scale_;
  if (exchange.is_write()) {
    take_order(end_ns);
  } else if (has_power) {
    take_reading(exchange.utc_ns, end_ns);
  }
}

/// An order may need several writes: it is in force after the last one before a read.
void RecordedSteps::take_order(std::int64_t end_ns) {
  std::int64_t order_w = 0;
  const bool is_active = map_.active.empty() || live_all(map_, map_.active, live_);
  if (!is_active || !live_power(map_, map_.order_power, live_, order_w)) {
    order_w_.reset();
    step_ = nullptr;
    return;
  }
  if (order_w != order_w_) {
    begin_step(order_w);
  } else if (power_w_.has_value()) {
    return;  // watchdog refresh
  }
  order_ns_ = end_ns;
}

void RecordedSteps::begin_step(std::int64_t order_w) {
  step_ = nullptr;
  const bool is_known = order_w_.has_value() && power_w_.has_value();
  const std::int64_t change_w = order_w - order_w_.value_or(0);
  const auto had_come = [&] { return std::abs(*power_w_ - *order_w_) <= band_w(*order_w_); };
  if (is_known) ++orders_;
  if (is_known && had_come()) {
    const auto step_w = static_cast<std::int32_t>(std::abs(change_w));
    sign_ = change_w > 0 ? 1 : -1;
    from_w_ = *power_w_;
    step_ = &curves_.emplace_back(step_w, band_w(order_w));
  }
  order_w_ = order_w;
  power_w_.reset();
}

void RecordedSteps::take_reading(std::int64_t begin_ns, std::int64_t end_ns) {
  std::int64_t power_w = 0;
  if (!live_power(map_, map_.measured_power, live_, power_w)) return;
  power_w_ = power_w;
  if (step_ == nullptr) return;
  step_->add({.begin_ms = (begin_ns - order_ns_) / 1'000'000,
              .end_ms = (end_ns - order_ns_) / 1'000'000,
              .along_w = static_cast<std::int32_t>(sign_ * (power_w - from_w_))});
}

std::int32_t RecordedSteps::band_w(std::int64_t order_w) const {
  return map_.response.tolerance_of_w(0, static_cast<std::int32_t>(std::abs(order_w)));
}

std::vector<const StepResponse*> RecordedSteps::whole() const {
  std::vector<const StepResponse*> whole;
  for (const StepResponse& curve : curves_) {
    const bool is_whole = curve.has_come() && curve.readings().size() >= kReadingsMin &&
                          curve.step_w() > 2 * curve.band_w();
    if (is_whole) whole.push_back(&curve);
  }
  return whole;
}

namespace {

constexpr std::int64_t kGapNsMax = 300 * kNanosecondsPerSecond;  // longer gaps: energy unknown
constexpr int kSocChangesMin = 3;
constexpr int kAnswersMin = 3;
constexpr double kMovedFracMin = 0.05;  // of the capacity, to call a SoC frozen
constexpr double kOrderWMin = 200;      // above the device's own consumption

}  // namespace

/// A reading's power applies to the time before it, because a controller reads just before an
/// order.
void EnergyEvidence::add(const EnergyReading& reading) {
  const std::int64_t passed_ns = reading.utc_ns - last_utc_ns_;
  const bool is_next = last_utc_ns_ != 0 && passed_ns > 0 && passed_ns <= kGapNsMax;
  last_utc_ns_ = reading.utc_ns;
  if (!is_next) {
    energy_wh_ = 0;
    soc_e4_ = reading.soc_e4;
    return;
  }
  constexpr double kNanosecondsPerHour = 3'600e9;
  balance(reading, static_cast<double>(reading.power_w) * static_cast<double>(passed_ns) /
                       kNanosecondsPerHour);
  compare(reading);
}

void EnergyEvidence::balance(const EnergyReading& reading, double energy_wh) {
  energy_wh_ += energy_wh;
  energy_moved_wh_ += std::abs(energy_wh);
  if (reading.soc_e4 == soc_e4_) return;
  if (soc_e4_.has_value() && reading.soc_e4.has_value()) {
    const auto moved_e4 = static_cast<double>(*reading.soc_e4 - *soc_e4_);
    soc_times_energy_ += moved_e4 * energy_wh_;
    energy_squared_ += energy_wh_ * energy_wh_;
    ++soc_changes_;
  }
  soc_e4_ = reading.soc_e4;
  energy_wh_ = 0;
}

void EnergyEvidence::compare(const EnergyReading& reading) {
  if (!reading.order_w.has_value() || reading.order_age_s < settle_s_) return;
  const auto order_w = static_cast<double>(*reading.order_w);
  const auto power_w = static_cast<double>(reading.power_w);
  const bool flows = std::abs(power_w) >= 0.1 * std::abs(order_w);
  if (std::abs(order_w) < kOrderWMin || !flows) return;  // full, empty, or cut by the device
  int& readings = (order_w > 0) == (power_w > 0) ? same_way_ : other_way_;
  ++readings;
  measured_w_ += std::abs(power_w);
  ordered_w_ += std::abs(order_w);
}

std::optional<double> EnergyEvidence::soc_per_energy(double capacity_wh) const {
  if (soc_changes_ < kSocChangesMin || energy_squared_ <= 0) return {};
  return soc_times_energy_ / energy_squared_ * capacity_wh / 1e4;
}

bool EnergyEvidence::soc_stands_still(double capacity_wh) const {
  return soc_e4_.has_value() && soc_changes_ == 0 &&
         energy_moved_wh_ >= kMovedFracMin * capacity_wh;
}

EnergyEvidence::Answer EnergyEvidence::answer() const {
  if (same_way_ + other_way_ < kAnswersMin) return Answer::kUnknown;
  return other_way_ > same_way_ ? Answer::kOpposite : Answer::kFollows;
}

std::optional<double> EnergyEvidence::power_per_order() const {
  if (same_way_ + other_way_ < kAnswersMin) return {};
  return measured_w_ / ordered_w_;
}

}  // namespace bess
