#include "workstation/env/evaluate.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "shared/units_and_limits.h"

namespace bess {
namespace {

constexpr double kWattsPerMegawatt = 1e6;

template <typename Field>
double mean_over_days(const std::vector<DayResult>& days, Field field) {
  double sum = 0;
  for (const DayResult& day : days) sum += field(day);
  return days.empty() ? 0.0 : sum / static_cast<double>(days.size());
}

double standard_error_of(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  if (values.size() < 2) return 0;
  double mean = 0;
  for (const double v : values) mean += v / n;
  double squares = 0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / (n - 1) / n);
}

class Runner {
 public:
  Runner(const MarketSteps& market, Policy& policy, const EvaluationOptions& options,
         std::vector<StepRecord>* records)
      : market_(market), policy_(policy), options_(options), records_(records) {}

  void reset_soc() {
    soc_frac_ = options_.initial_soc_frac;
    last_action_ = Action::kIdle;
  }

  /// Announces the steps that follow each other without a reset of the SoC.
  void begin(std::span<const MarketStep> ahead) {
    policy_.begin(ahead);
    index_ = 0;
  }

  DayResult run(const MarketDay& day) {
    DayResult result{day.date(), 0, 0, 0, 0};
    double energy_mwh = 0;
    for (const MarketStep& step : market_.of(day)) {
      const Action action = policy_.decide(step, index_++, soc_frac_);
      const BatteryStep moved =
          battery_step(options_.battery, soc_frac_,
                       power_sign(action) * options_.battery.power_w_max, kHoursPerStep);
      const double mwh = moved.power_w / kWattsPerMegawatt * kHoursPerStep;
      const double profit_eur = -mwh * step.paid_eur_per_mwh;
      result.profit_eur += profit_eur;
      energy_mwh += std::fabs(mwh);
      result.switches += action != last_action_ ? 1 : 0;
      if (records_ != nullptr) {
        records_->push_back({step.utc_s, step.observed_eur_per_mwh, step.paid_eur_per_mwh,
                             soc_frac_, action, moved.power_w, profit_eur});
      }
      last_action_ = action;
      soc_frac_ = moved.soc_frac;
    }
    result.cycles = energy_mwh / (2 * options_.battery.capacity_wh / kWattsPerMegawatt);
    result.soc_end_frac = soc_frac_;
    return result;
  }

 private:
  const MarketSteps& market_;
  Policy& policy_;
  const EvaluationOptions& options_;
  std::vector<StepRecord>* records_;
  std::size_t index_ = 0;  ///< of the step, from the last begin()
  double soc_frac_ = 0.5;
  Action last_action_ = Action::kIdle;
};

}  // namespace

double Evaluation::profit_eur_per_day_per_mwh() const {
  return mean_over_days(days, [](const DayResult& d) { return d.profit_eur; }) / capacity_mwh;
}
double Evaluation::standard_error() const {
  std::vector<double> profits;
  for (const DayResult& day : days) profits.push_back(day.profit_eur / capacity_mwh);
  return standard_error_of(profits);
}
double Evaluation::worst_day_eur_per_mwh() const {
  const auto worst = std::ranges::min_element(days, {}, &DayResult::profit_eur);
  return worst == days.end() ? 0.0 : worst->profit_eur / capacity_mwh;
}
double Evaluation::cycles_per_day() const {
  return mean_over_days(days, [](const DayResult& d) { return d.cycles; });
}
double Evaluation::switches_per_day() const {
  return mean_over_days(days, [](const DayResult& d) { return static_cast<double>(d.switches); });
}
double Evaluation::soc_end_mean() const {
  return mean_over_days(days, [](const DayResult& d) { return d.soc_end_frac; });
}

Evaluation evaluate(const MarketSteps& market, const std::vector<MarketDay>& days, Policy& policy,
                    const EvaluationOptions& options, std::vector<StepRecord>* records) {
  Evaluation evaluation;
  evaluation.capacity_mwh = options.battery.capacity_wh / kWattsPerMegawatt;
  Runner runner(market, policy, options, records);
  std::vector<MarketStep> chained;  // carried over: foresight plans across the chained days
  for (const MarketDay& day : days) {
    const auto steps = market.of(day);
    if (options.carry_soc) chained.insert(chained.end(), steps.begin(), steps.end());
  }
  runner.reset_soc();
  runner.begin(chained);
  for (const MarketDay& day : days) {
    if (!options.carry_soc) {
      runner.reset_soc();
      runner.begin(market.of(day));
    }
    evaluation.days.push_back(runner.run(day));
  }
  return evaluation;
}

PairedDifference paired_difference(const Evaluation& a, const Evaluation& b) {
  if (a.days.size() != b.days.size() || a.days.empty()) {
    throw std::logic_error("paired difference needs the same days on both sides");
  }
  std::vector<double> differences;
  double mean = 0;
  for (std::size_t d = 0; d < a.days.size(); ++d) {
    differences.push_back(a.days[d].profit_eur / a.capacity_mwh -
                          b.days[d].profit_eur / b.capacity_mwh);
    mean += differences.back() / static_cast<double>(a.days.size());
  }
  return {mean, standard_error_of(differences)};
}

}  // namespace bess
