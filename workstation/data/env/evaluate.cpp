#include "workstation/data/env/evaluate.h"

#include <algorithm>
#include <stdexcept>

#include "shared/battery_model.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

template <typename Field>
double mean_over_days(const std::vector<DayResult>& days, Field field) {
  double sum = 0;
  for (const DayResult& day : days) sum += field(day);
  return days.empty() ? 0.0 : sum / static_cast<double>(days.size());
}

class Runner {
 public:
  Runner(Policy& policy, const EvaluationOptions& options)
      : policy_(policy),
        options_(options),
        battery_(options.battery),
        soc_frac_(options.initial_soc_frac) {}

  void reset_soc() {
    soc_frac_ = options_.initial_soc_frac;
    last_action_ = Action::kIdle;
    run_steps_ = 0;
    power_ = {};
  }

  [[nodiscard]] double soc_frac() const { return soc_frac_; }

  /// Runs steps of one day; `index` counts from the policy's begin().
  DayResult run(const std::string& date, std::span<const MarketStep> steps, std::size_t index,
                std::vector<StepRecord>* records) {
    const BatteryParameters& battery = battery_;
    const double two_capacities_mwh = 2 * options_.battery.capacity_wh / kWattsPerMegawatt;
    const double energy_mwh_max = battery.cycles_per_day_max > 0
                                      ? battery.cycles_per_day_max * two_capacities_mwh
                                      : std::numeric_limits<double>::infinity();
    DayResult result{date, 0, 0, 0, 0};
    result.soc_start_frac = soc_frac_;
    double energy_mwh = 0;
    for (const MarketStep& step : steps) {
      Action action = policy_.decide(step, index++, soc_frac_);
      if (must_go_on()) action = last_action_;
      if (energy_mwh >= energy_mwh_max) action = Action::kIdle;
      const double power_w =
          ordered_power_w(battery, step, action, policy_.power_share_max(step, soc_frac_));
      const auto [moved, power] = response_step(battery, soc_frac_, power_, power_w, kHoursPerStep);
      const double mwh = moved.power_w / kWattsPerMegawatt * kHoursPerStep;
      const double profit_eur = step_profit_eur(battery, mwh, kHoursPerStep, step.paid_eur_per_mwh);
      result.profit_eur += profit_eur;
      energy_mwh += std::fabs(mwh);
      result.switches += action != last_action_ ? 1 : 0;
      if (records != nullptr) {
        records->push_back({step.utc_s, step.observed_eur_per_mwh, step.paid_eur_per_mwh,
                            step.level_eur_per_mwh(), soc_frac_, action, moved.power_w,
                            profit_eur});
      }
      run_steps_ = action == last_action_ ? run_steps_ + 1 : 1;
      last_action_ = action;
      soc_frac_ = moved.soc_frac;
      power_ = power;
      fade(mwh);
    }
    result.cycles = energy_mwh / two_capacities_mwh;
    result.throughput_mwh = energy_mwh;
    result.soc_end_frac = soc_frac_;
    return result;
  }

 private:
  [[nodiscard]] bool must_go_on() const {
    return last_action_ != Action::kIdle && run_steps_ * kMinutesPerStep < battery_.minimum_run_min;
  }
  /// Capacity fade by throughput, as in bess-train size.
  void fade(double mwh) {
    const double cycles = std::fabs(mwh) * kWattsPerMegawatt / (2 * battery_.capacity_wh);
    battery_.capacity_wh *= 1 - battery_.fade_percent_per_1000_cycles / 100 / 1000 * cycles;
  }

  Policy& policy_;
  const EvaluationOptions& options_;
  BatteryParameters battery_;  ///< with its faded capacity
  double soc_frac_;
  PowerState power_;  ///< at the end of the previous step
  Action last_action_ = Action::kIdle;
  int run_steps_ = 0;  ///< steps in this direction without a change
};

/// Carried-over foresight: one plan and one run over the whole series, of which `days` count.
std::vector<DayResult> run_whole_series(const MarketSteps& market,
                                        const std::vector<MarketDay>& days, Policy& policy,
                                        const EvaluationOptions& options,
                                        std::vector<StepRecord>* records) {
  const std::size_t first = market.days.front().first_step;
  const std::span<const MarketStep> series{
      market.steps.data() + first,
      market.days.back().first_step + market.days.back().step_count - first};
  policy.begin(series, options.initial_soc_frac);
  Runner runner(policy, options);
  std::vector<DayResult> results;
  std::size_t done = 0;
  for (const MarketDay& day : market.days) {
    const std::size_t at = day.first_step - first;
    runner.run("", series.subspan(done, at - done), done, nullptr);  // days left out
    const bool counts =
        std::ranges::find(days, day.first_step, &MarketDay::first_step) != days.end();
    DayResult result = runner.run(day.date(), market.of(day), at, counts ? records : nullptr);
    if (counts) results.push_back(std::move(result));
    done = at + day.step_count;
  }
  return results;
}

}  // namespace

double Evaluation::profit_eur_per_day_per_mwh() const {
  return mean_over_days(days, [](const DayResult& d) { return d.profit_eur; }) / capacity_mwh;
}
double Evaluation::profit_at_wear_eur_per_day_per_mwh(double other_wear_eur_per_mwh) const {
  const double throughput_mwh_per_day =
      mean_over_days(days, [](const DayResult& d) { return d.throughput_mwh; });
  return profit_eur_per_day_per_mwh() -
         (other_wear_eur_per_mwh - wear_eur_per_mwh) * throughput_mwh_per_day / capacity_mwh;
}
ChargeLeft Evaluation::charge_left() const {
  const double value =
      mean_over_days(days, [](const DayResult& d) { return d.charge_value_eur; }) / capacity_mwh;
  return {charge_price_eur_per_mwh, values_charge_left() ? value : charge_price_eur_per_mwh};
}
DayErrors Evaluation::errors() const {
  std::vector<DayValue> profits;
  for (const DayResult& day : days) profits.emplace_back(day.date, day.profit_eur / capacity_mwh);
  return day_errors(profits);
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
  evaluation.wear_eur_per_mwh = options.battery.wear_eur_per_mwh;
  if (options.carry_soc && policy.sees_future()) {
    evaluation.days = run_whole_series(market, days, policy, options, records);
    return evaluation;
  }
  Runner runner(policy, options);
  for (const MarketDay& day : days) {
    if (!options.carry_soc) runner.reset_soc();
    policy.begin(market.of(day), runner.soc_frac());
    evaluation.days.push_back(runner.run(day.date(), market.of(day), 0, records));
  }
  return evaluation;
}

PairedDifference paired_difference(const Evaluation& a, const Evaluation& b) {
  if (a.days.empty() ||
      !std::ranges::equal(a.days, b.days, {}, &DayResult::date, &DayResult::date)) {
    throw std::logic_error("paired difference needs the same days on both sides");
  }
  std::vector<DayValue> differences;
  double mean = 0;
  for (std::size_t d = 0; d < a.days.size(); ++d) {
    differences.emplace_back(a.days[d].date, a.days[d].profit_eur / a.capacity_mwh -
                                                 b.days[d].profit_eur / b.capacity_mwh);
    mean += differences.back().second / static_cast<double>(a.days.size());
  }
  return {mean, day_errors(differences)};
}

double mean_settled_eur_per_mwh(const MarketSteps& market, const std::vector<MarketDay>& days) {
  double sum = 0;
  std::size_t steps = 0;
  for (const MarketDay& day : days) {
    for (const MarketStep& step : market.of(day)) sum += step.paid_eur_per_mwh;
    steps += day.step_count;
  }
  return sum / static_cast<double>(steps);
}

void value_charge_left(Evaluation& carried_over, const BatteryParameters& battery,
                       double price_eur_per_mwh) {
  if (carried_over.values_charge_left()) throw std::logic_error("final charge already valued");
  if (carried_over.days.empty()) return;
  double gained_frac = 0;
  for (const DayResult& day : carried_over.days)
    gained_frac += day.soc_end_frac - day.soc_start_frac;
  const double stored_mwh = gained_frac * battery.capacity_wh / kWattsPerMegawatt;
  const double exchanged_mwh = stored_mwh > 0 ? -stored_mwh * battery.discharge_efficiency
                                              : -stored_mwh / battery.charge_efficiency;
  DayResult& last = carried_over.days.back();
  last.charge_value_eur = -exchange_cost_eur(battery, exchanged_mwh, price_eur_per_mwh);
  last.profit_eur += last.charge_value_eur;
  last.throughput_mwh += std::fabs(exchanged_mwh);
  carried_over.charge_price_eur_per_mwh = price_eur_per_mwh;
}

Evaluation evaluate_carried_over(const MarketSteps& market, const std::vector<MarketDay>& days,
                                 Policy& policy, const BatteryParameters& battery,
                                 double initial_soc_frac, std::vector<StepRecord>* records) {
  Evaluation done = evaluate(market, days, policy, {battery, initial_soc_frac, true}, records);
  value_charge_left(done, battery, mean_settled_eur_per_mwh(market, days));
  return done;
}

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
