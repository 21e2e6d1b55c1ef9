#include "workstation/report/backtest/walk_forward.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "shared/host/user_error.h"
#include "workstation/data/env/evaluate.h"

namespace bess {
namespace {

constexpr double kWindowShareMin = 0.5;

LocalDate date_of(const MarketDay& day) { return {day.year, day.month, day.day}; }

/// Index of the first day on or after `date`.
std::size_t day_from(const MarketSteps& market, const LocalDate& date) {
  const auto found = std::ranges::lower_bound(market.days, date, {}, date_of);
  return static_cast<std::size_t>(found - market.days.begin());
}

/// Days [first, known) and [traded, end) of `market`, the latter as test days, without earlier and
/// later steps.
MarketSteps cut_out(const MarketSteps& market, std::size_t first, std::size_t known,
                    std::size_t traded, std::size_t end) {
  const std::size_t first_step = market.days[first].first_step;
  const std::size_t end_step = market.days[end - 1].first_step + market.days[end - 1].step_count;
  MarketSteps cut;
  cut.steps.assign(market.steps.begin() + static_cast<std::ptrdiff_t>(first_step),
                   market.steps.begin() + static_cast<std::ptrdiff_t>(end_step));
  for (std::size_t d = first; d < end; ++d) {
    if (d >= known && d < traded) continue;
    MarketDay day = market.days[d];
    day.first_step -= first_step;
    if (d >= traded) {
      day.split = Split::kTest;
    } else if (day.split == Split::kTest) {
      day.split = Split::kTrain;
    }
    cut.days.push_back(day);
  }
  cut.day_ahead = market.day_ahead;  // referenced by its steps
  return cut;
}

/// Traded periods of a plan, first and last day.
std::vector<std::pair<LocalDate, LocalDate>> stretches(const std::vector<MarketDay>& days,
                                                       const FoldPlan& plan) {
  std::vector<std::pair<LocalDate, LocalDate>> all;
  for (const MarketDay& day : days) {
    if (!all.empty() && date_of(day) <= all.back().second) continue;
    if (plan.traded_days > 0) {
      all.emplace_back(date_of(day), add_days(date_of(day), plan.traded_days - 1));
    } else {
      const LocalDate next{day.year + day.month / 12, day.month % 12 + 1, 1};
      all.emplace_back(LocalDate{day.year, day.month, 1}, add_days(next, -1));
    }
  }
  return all;
}

/// Appends the days of a fold.
void append(const Evaluation& fold, Evaluation& all) {
  all.capacity_mwh = fold.capacity_mwh;
  all.wear_eur_per_mwh = fold.wear_eur_per_mwh;
  all.days.insert(all.days.end(), fold.days.begin(), fold.days.end());
}

double mean_settled_of(const Evaluation& traded, const MarketSteps& market) {
  std::vector<MarketDay> days = market.days;
  std::erase_if(days, [&](const MarketDay& day) {
    return std::ranges::find(traded.days, day.date(), &DayResult::date) == traded.days.end();
  });
  return mean_settled_eur_per_mwh(market, days);
}

}  // namespace

std::variant<Fold, SkippedMonth> make_fold(const MarketSteps& market, const std::string& name,
                                           const LocalDate& first, const LocalDate& last,
                                           const FoldPlan& plan) {
  const LocalDate until = add_days(first, -plan.lag_days);
  const std::size_t window = day_from(market, add_days(until, -plan.window_days));
  const std::size_t known = day_from(market, until);
  const std::size_t traded = day_from(market, first);
  const std::size_t end = day_from(market, add_days(last, 1));
  if (static_cast<double>(known - window) < kWindowShareMin * plan.window_days) {
    return SkippedMonth{name, fmt::format("only {} of the {} days before it have prices",
                                          known - window, plan.window_days)};
  }
  Fold fold{name, cut_out(market, window, known, traded, end)};
  if (fold.market.days_of(Split::kTrain).empty() ||
      fold.market.days_of(Split::kValidation).empty()) {
    return SkippedMonth{name, "no training or validation days before it"};
  }
  return fold;
}

FoldRegimes regimes_of(const Fold& fold) {
  const auto met = [&](const std::vector<MarketDay>& days) {
    return regimes_met(fold.market.span_of(days));
  };
  return {met(fold.market.fitted_days()), met(fold.market.days_of(Split::kTest))};
}

Folds make_folds(const MarketSteps& market, const FoldPlan& plan) {
  Folds folds;
  for (const auto& [first, last] : stretches(market.days, plan)) {
    const std::string date = format_local_date(first);
    auto made =
        make_fold(market, plan.traded_days > 0 ? date : date.substr(0, 7), first, last, plan);
    if (auto* skipped = std::get_if<SkippedMonth>(&made)) {
      folds.skipped.push_back(std::move(*skipped));
    } else {
      folds.traded.push_back(std::move(std::get<Fold>(made)));
    }
  }
  if (folds.traded.empty()) {
    fail(
        "no month has {} complete days in the {} days before it; use more prices or a shorter "
        "window",
        static_cast<int>(std::ceil(kWindowShareMin * plan.window_days)), plan.window_days);
  }
  return folds;
}

std::vector<double> WalkForward::cumulative_eur_per_mwh() const {
  return cumulative(daily_profits(total));
}

double WalkForward::drawdown_eur_per_mwh() const { return drawdown(daily_profits(total)); }

WalkForward walk_forward(const std::string& name, const Folds& folds, const FoldPolicy& make,
                         const BatteryParameters& battery, double initial_soc_frac,
                         const MarketSteps& market, bool and_day_reset,
                         std::vector<StepRecord>* records) {
  WalkForward result{.name = name};
  EvaluationOptions options{battery, initial_soc_frac, true};
  for (const Fold& fold : folds.traded) {
    const std::shared_ptr<Policy> policy = make(fold);
    const std::vector<MarketDay> traded = fold.market.days_of(Split::kTest);
    Evaluation evaluation;
    if (policy->sees_future()) {
      std::vector<MarketDay> days = market.days;
      std::erase_if(days, [&](const MarketDay& day) {
        return date_of(day) < date_of(traded.front()) || date_of(day) > date_of(traded.back());
      });
      evaluation = evaluate(market, days, *policy, options, records);
    } else {
      evaluation = evaluate(fold.market, traded, *policy, options, records);
      options.initial_soc_frac = evaluation.days.back().soc_end_frac;
    }
    if (and_day_reset) {
      append(evaluate(fold.market, traded, *policy, {battery, initial_soc_frac, false}),
             result.day_reset);
    }
    append(evaluation, result.total);
    result.by_month.push_back(std::move(evaluation));
  }
  value_charge_left(result.total, battery, mean_settled_of(result.total, market));
  result.by_month.back().days.back() = result.total.days.back();
  return result;
}

}  // namespace bess
