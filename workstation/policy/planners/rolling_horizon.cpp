#include "workstation/policy/planners/baselines.h"

#include <algorithm>
#include <cmath>

namespace bess {
namespace {

constexpr int kSocPoints = RollingHorizonPolicy::kSocPoints;
constexpr int kDeviations = 33;
constexpr int kHorizonQuarterHours = 96;
constexpr double kDeviationMaxEurPerMwh = 1500;
constexpr double kPersistenceMax = 0.99;
/// A step that starts at minute 14 is half in the next quarter-hour and is skipped.
constexpr int kStraddlingMinute = 14;

/// Deviations are tabulated densely near 0, sparsely far out: d = max * x * |x|, x even in [-1, 1].
double deviation_at(int index) {
  const double x = 2.0 * index / (kDeviations - 1) - 1;
  return kDeviationMaxEurPerMwh * x * std::fabs(x);
}
double deviation_position(double deviation) {
  const double ratio = std::clamp(deviation / kDeviationMaxEurPerMwh, -1.0, 1.0);
  const double x = std::copysign(std::sqrt(std::fabs(ratio)), ratio);
  return (x + 1) / 2 * (kDeviations - 1);
}

/// Steps that start in a quarter-hour: at minutes 0 to 14 in the first of a half-hour, 1 to 13 in
/// the second.
int steps_of(int quarter_hour) { return quarter_hour % 2 == 0 ? 8 : 7; }

/// Remaining steps of this quarter-hour, this one included.
int steps_left(const MarketStep& step) {
  return (kMinutesPerQuarterHour + 1 - step.minute_of_quarter_hour) / 2;
}

std::size_t row_of(int quarter_hour, int deviation) {
  return (static_cast<std::size_t>(quarter_hour) * kDeviations +
          static_cast<std::size_t>(deviation)) *
         kSocPoints;
}

double ratio_or_zero(double numerator, double denominator) {
  return denominator > 0 ? numerator / denominator : 0.0;
}

}  // namespace

RollingHorizonPolicy::RollingHorizonPolicy(const MarketSteps& market,
                                           const std::vector<MarketDay>& days,
                                           const BatteryParameters& battery)
    : battery_(battery), grid_(battery, kSocPoints), sweep_(battery, grid_) {
  require_training_days(days.size());
  fit_usual_prices(market, days);
  fit_persistence(market, days);
  fit_shrinkage(market, days);
  tabulate_values();
}

void RollingHorizonPolicy::fit_usual_prices(const MarketSteps& market,
                                            const std::vector<MarketDay>& days) {
  std::array<double, kQuarterHourCount> sum{};
  std::array<double, kQuarterHourCount> count{};
  for_each_step(market, days, [&](const MarketStep& step) {
    if (step.minute_of_quarter_hour == kStraddlingMinute) return;
    sum[step.quarter_hour] += step.paid_eur_per_mwh;
    count[step.quarter_hour] += 1;
  });
  for (int q = 0; q < kQuarterHourCount; ++q)
    usual_eur_per_mwh_[q] = ratio_or_zero(sum[q], count[q]);
}

void RollingHorizonPolicy::fit_persistence(const MarketSteps& market,
                                           const std::vector<MarketDay>& days) {
  double product = 0;
  double square = 0;
  for (const MarketDay& day : days) {
    const MarketStep* before = nullptr;
    for (const MarketStep& step : market.of(day)) {
      if (step.minute_of_quarter_hour > 1) continue;  // only the first step of each quarter-hour
      if (before != nullptr) {
        const double was = before->paid_eur_per_mwh - usual_eur_per_mwh_[before->quarter_hour];
        product += was * (step.paid_eur_per_mwh - usual_eur_per_mwh_[step.quarter_hour]);
        square += was * was;
      }
      before = &step;
    }
  }
  persistence_ = std::clamp(ratio_or_zero(product, square), 0.0, kPersistenceMax);
}

void RollingHorizonPolicy::fit_shrinkage(const MarketSteps& market,
                                         const std::vector<MarketDay>& days) {
  std::array<double, kMinutesPerQuarterHour> product{};
  std::array<double, kMinutesPerQuarterHour> square{};
  ordinary_age_quarter_hours_.fill(kQuarterHourCount);
  for_each_step(market, days, [&](const MarketStep& step) {
    const double seen = observed_deviation(step);
    const double is = step.paid_eur_per_mwh - usual_eur_per_mwh_[step.quarter_hour];
    product[step.minute_of_quarter_hour] += seen * is;
    square[step.minute_of_quarter_hour] += seen * seen;
    ordinary_age_quarter_hours_[step.minute_of_quarter_hour] = std::min(
        ordinary_age_quarter_hours_[step.minute_of_quarter_hour], step.quarter_hours_ago());
  });
  for (int t = 0; t < kMinutesPerQuarterHour; ++t) {
    shrinkage_[t] = std::clamp(ratio_or_zero(product[t], square[t]), 0.0, 1.0);
  }
}

double RollingHorizonPolicy::observed_deviation(const MarketStep& step) const {
  return step.observed_eur_per_mwh - usual_eur_per_mwh_[step.row_quarter_hour()];
}

double RollingHorizonPolicy::deviation_now(const MarketStep& step) const {
  const int quarter_hours_late = std::max(
      0, step.quarter_hours_ago() - ordinary_age_quarter_hours_[step.minute_of_quarter_hour]);
  return shrinkage_[step.minute_of_quarter_hour] * std::pow(persistence_, quarter_hours_late) *
         observed_deviation(step);
}

void RollingHorizonPolicy::tabulate_values() {
  value_.assign(row_of(kQuarterHourCount, 0), 0.0F);
  for (int horizon = 1; horizon <= kHorizonQuarterHours; ++horizon) {
    const std::vector<float> shorter = value_;
    for (int q = 0; q < kQuarterHourCount; ++q) {
      for (int d = 0; d < kDeviations; ++d) {
        std::ranges::copy(plan(shorter, q, deviation_at(d), steps_of(q)),
                          value_.begin() + row_of(q, d));
      }
    }
  }
}

RollingHorizonPolicy::Values RollingHorizonPolicy::plan(const std::vector<float>& later,
                                                        int quarter_hour, double deviation,
                                                        int steps) const {
  const double position = deviation_position(persistence_ * deviation);
  const int lower = std::min(static_cast<int>(position), kDeviations - 2);
  const auto weight = static_cast<float>(position - lower);
  const float* a = &later[row_of((quarter_hour + 1) % kQuarterHourCount, lower)];
  const float* b = a + kSocPoints;
  Values next;
  Values now;
  for (int i = 0; i < kSocPoints; ++i) next[i] = a[i] * (1 - weight) + b[i] * weight;
  const auto price = static_cast<float>(usual_eur_per_mwh_[quarter_hour] + deviation);
  for (int s = 0; s < steps; ++s) {
    sweep_.run(next.data(), quarter_hour, price, now.data());
    std::swap(next, now);
  }
  return next;
}

Action RollingHorizonPolicy::decide(const MarketStep& step, std::size_t, double soc_frac) const {
  const double deviation = deviation_now(step);
  const Values next = plan(value_, step.quarter_hour, deviation, steps_left(step) - 1);
  const double price = usual_eur_per_mwh_[step.quarter_hour] + deviation;
  return best_action(battery_, grid_, next.data(), step.quarter_hour, price, soc_frac);
}

}  // namespace bess
