#include "edge/recording/energy_evidence.h"

#include <cmath>

#include "shared/scaled_clock.h"

namespace bess {
namespace {

constexpr std::int64_t kGapNsMax = 300 * kNanosecondsPerSecond;  // beyond, nobody knows what flowed
constexpr int kSocChangesMin = 3;
constexpr int kAnswersMin = 3;
constexpr double kMovedFracMin = 0.05;  // of the capacity, before a SoC can be said to stand still
constexpr double kOrderWMin = 200;      // smaller powers drown in what the device needs itself

}  // namespace

/// A reading's power is taken as that of the time before it: a controller reads just before it
/// orders.
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
  (order_w > 0) == (power_w > 0) ? ++same_way_ : ++other_way_;
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
