// How much a policy's days scatter, and how deep they fall: one definition of each, for every page
// and table. All are of what a day brought (profit, or gain over another policy), by day and not
// annualised.
//
//   win rate        share of the days that brought more than nothing
//   Sortino         mean over the downside deviation, sqrt(mean(min(0, day)^2)) over all days: target 0
//                   [Sortino and Price 1994]; unknown when no day lost
//   value at risk   at 95 %: minus the 5 % quantile of the days (linear between neighbours), the loss that 19 of 20
//                   days stay above; negative when even that day earned
//   drawdown        deepest fall of what all days before together brought, from the end of a day to that of a later one,
//                   the beginning being 0; never within a day
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "workstation/env/evaluate.h"

namespace bess {

inline constexpr double kValueAtRiskShare = 0.05;  ///< of the days lie below it

struct DayRisk {
  double win_rate = 0;  ///< 0..1
  std::optional<double> sortino{};
  double value_at_risk = 0;  ///< in the unit of the days, a loss positive
  double drawdown = 0;       ///< not negative
};
/// Not of no day.
DayRisk day_risk(std::span<const double> days);

/// EUR per MWh of capacity, by day.
std::vector<double> daily_profits(const Evaluation& evaluation);
/// The same minus that of `other` on the same day; the same days required.
std::vector<double> daily_gains(const Evaluation& evaluation, const Evaluation& other);

/// Running sum.
std::vector<double> cumulative(std::span<const double> days);
/// Each sum minus the highest until then, 0 at the beginning included: not positive.
std::vector<double> below_peak(std::span<const double> cumulative);

}  // namespace bess
