#include "workstation/data/env/drawdown.h"

#include <algorithm>

namespace bess {

std::vector<double> daily_profits(const Evaluation& evaluation) {
  std::vector<double> profits;
  for (const DayResult& day : evaluation.days) {
    profits.push_back(day.profit_eur / evaluation.capacity_mwh);
  }
  return profits;
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

double drawdown(std::span<const double> days) {
  double deepest = 0;
  for (const double fall : below_peak(cumulative(days))) deepest = std::max(deepest, -fall);
  return deepest;
}

}  // namespace bess
