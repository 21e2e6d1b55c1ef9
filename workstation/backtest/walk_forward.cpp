#include "workstation/backtest/walk_forward.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "shared/host/user_error.h"
#include "workstation/env/charge_left.h"
#include "workstation/env/day_risk.h"
#include "workstation/market/series/local_date.h"

namespace bess {
namespace {

constexpr double kWindowShareMin = 0.5;

bool same_month(const MarketDay& a, const MarketDay& b) {
  return a.year == b.year && a.month == b.month;
}

LocalDate date_of(const MarketDay& day) { return {day.year, day.month, day.day}; }

/// The days [first, end) of `market` with their steps and nothing else; the last `traded` are test
/// days.
MarketSteps cut_out(const MarketSteps& market, std::size_t first, std::size_t end,
                    std::size_t traded) {
  const std::size_t first_step = market.days[first].first_step;
  const std::size_t end_step = market.days[end - 1].first_step + market.days[end - 1].step_count;
  MarketSteps cut;
  cut.steps.assign(market.steps.begin() + static_cast<std::ptrdiff_t>(first_step),
                   market.steps.begin() + static_cast<std::ptrdiff_t>(end_step));
  for (std::size_t d = first; d < end; ++d) {
    MarketDay day = market.days[d];
    day.first_step -= first_step;
    if (d + traded >= end) {
      day.split = Split::kTest;
    } else if (day.split == Split::kTest) {
      day.split = Split::kTrain;
    }
    cut.days.push_back(day);
  }
  cut.day_ahead = market.day_ahead;  // its steps point to it
  return cut;
}

/// The months that `days` hold, each as [first, end).
std::vector<std::pair<std::size_t, std::size_t>> months_of(const std::vector<MarketDay>& days) {
  std::vector<std::pair<std::size_t, std::size_t>> months;
  for (std::size_t d = 0; d < days.size(); ++d) {
    if (d == 0 || !same_month(days[d], days[d - 1])) months.emplace_back(d, d);
    months.back().second = d + 1;
  }
  return months;
}

double mean_settled_of(const Evaluation& traded, const MarketSteps& market) {
  std::vector<MarketDay> days = market.days;
  std::erase_if(days, [&](const MarketDay& day) {
    return std::ranges::find(traded.days, day.date(), &DayResult::date) == traded.days.end();
  });
  return mean_settled_eur_per_mwh(market, days);
}

}  // namespace

Folds make_folds(const MarketSteps& market, int window_days) {
  Folds folds;
  for (const auto& [first, end] : months_of(market.days)) {
    const MarketDay& day = market.days[first];
    const std::string month = fmt::format("{:04}-{:02}", day.year, day.month);
    const LocalDate since = add_days({day.year, day.month, 1}, -window_days);
    std::size_t window = first;
    while (window > 0 && date_of(market.days[window - 1]) >= since) --window;
    const std::size_t known = first - window;
    if (static_cast<double>(known) < kWindowShareMin * window_days) {
      folds.skipped.push_back(
          {month, fmt::format("{} of the {} days before it are there", known, window_days)});
      continue;
    }
    Fold fold{month, cut_out(market, window, end, end - first)};
    if (fold.market.days_of(Split::kTrain).empty() ||
        fold.market.days_of(Split::kValidation).empty()) {
      folds.skipped.push_back({month, "no training or no validation days before it"});
      continue;
    }
    folds.traded.push_back(std::move(fold));
  }
  if (folds.traded.empty()) {
    fail("no month has {} complete days in the {} before it; give more prices or a shorter window",
         static_cast<int>(std::ceil(kWindowShareMin * window_days)), window_days);
  }
  return folds;
}

std::vector<double> WalkForward::cumulative_eur_per_mwh() const {
  return cumulative(daily_profits(total));
}

double WalkForward::drawdown_eur_per_mwh() const { return day_risk(daily_profits(total)).drawdown; }

WalkForward walk_forward(const std::string& name, const Folds& folds, const FoldPolicy& make,
                         const BatteryParameters& battery, double initial_soc_frac,
                         const MarketSteps& market, bool and_day_reset) {
  WalkForward result{.name = name, .total = {}, .months = {}, .by_month = {}};
  EvaluationOptions options{battery, initial_soc_frac, true};
  for (const Fold& fold : folds.traded) {
    const std::shared_ptr<Policy> policy = make(fold);
    const std::vector<MarketDay> traded = fold.market.days_of(Split::kTest);
    Evaluation evaluation;
    if (policy->sees_future()) {
      std::vector<MarketDay> days = market.days;
      std::erase_if(days, [&](const MarketDay& day) { return !same_month(day, traded.front()); });
      evaluation = evaluate(market, days, *policy, options);
    } else {
      evaluation = evaluate(fold.market, traded, *policy, options);
      options.initial_soc_frac = evaluation.days.back().soc_end_frac;
    }
    if (and_day_reset) {
      const Evaluation reset =
          evaluate(fold.market, traded, *policy, {battery, initial_soc_frac, false});
      result.day_reset.capacity_mwh = reset.capacity_mwh;
      result.day_reset.wear_eur_per_mwh = reset.wear_eur_per_mwh;
      result.day_reset.days.insert(result.day_reset.days.end(), reset.days.begin(),
                                   reset.days.end());
    }
    result.total.capacity_mwh = evaluation.capacity_mwh;
    result.total.wear_eur_per_mwh = evaluation.wear_eur_per_mwh;
    result.total.days.insert(result.total.days.end(), evaluation.days.begin(),
                             evaluation.days.end());
    result.months.push_back(fold.month);
    result.by_month.push_back(std::move(evaluation));
  }
  value_charge_left(result.total, battery, mean_settled_of(result.total, market));
  result.by_month.back().days.back() = result.total.days.back();
  return result;
}

}  // namespace bess
