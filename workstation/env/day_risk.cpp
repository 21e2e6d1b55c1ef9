#include "workstation/env/day_risk.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bess {
namespace {

double quantile(std::vector<double> values, double probability) {
  std::ranges::sort(values);
  const double at = probability * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return std::lerp(values[below], values[above], at - static_cast<double>(below));
}

}  // namespace

DayRisk day_risk(std::span<const double> days) {
  if (days.empty()) throw std::logic_error("there is no risk without a day");
  const auto count = static_cast<double>(days.size());
  double sum = 0;
  double squared_losses = 0;
  double wins = 0;
  for (const double day : days) {
    sum += day;
    squared_losses += day < 0 ? day * day : 0;
    wins += day > 0 ? 1 : 0;
  }
  DayRisk risk{.win_rate = wins / count};
  if (squared_losses > 0) risk.sortino = sum / count / std::sqrt(squared_losses / count);
  // 0 - x: a loss of nothing is no negative zero.
  risk.value_at_risk = 0 - quantile({days.begin(), days.end()}, kValueAtRiskShare);
  risk.drawdown = 0 - std::ranges::min(below_peak(cumulative(days)));
  return risk;
}

std::vector<double> daily_profits(const Evaluation& evaluation) {
  std::vector<double> profits;
  for (const DayResult& day : evaluation.days) {
    profits.push_back(day.profit_eur / evaluation.capacity_mwh);
  }
  return profits;
}

std::vector<double> daily_gains(const Evaluation& evaluation, const Evaluation& other) {
  std::vector<double> gains = daily_profits(evaluation);
  const std::vector<double> others = daily_profits(other);
  if (gains.size() != others.size()) throw std::logic_error("gains need the same days");
  for (std::size_t d = 0; d < gains.size(); ++d) gains[d] -= others[d];
  return gains;
}

std::vector<double> cumulative(std::span<const double> days) {
  std::vector<double> sums;
  double sum = 0;
  for (const double day : days) sums.push_back(sum += day);
  return sums;
}

std::vector<double> below_peak(std::span<const double> cumulative) {
  std::vector<double> falls;
  double peak = 0;
  for (const double sum : cumulative) {
    peak = std::max(peak, sum);
    falls.push_back(sum - peak);
  }
  return falls;
}

}  // namespace bess
