#include "workstation/runs/impact/fleet_market.h"

#include <algorithm>
#include <cmath>

#include "shared/battery_model.h"
#include "shared/local_time.h"
#include "shared/price_level.h"
#include "workstation/data/market/model/simulated_market.h"
#include "workstation/data/market/series/imbalance_price.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {
namespace {

constexpr double kUpwardEurPerMwhPerMw = 0.19;
constexpr double kDownwardEurPerMwhPerMw = 0.28;
constexpr double kDeadBandMw = 25;

double shortage_of(double imbalance_mw) { return std::max(0.0, -imbalance_mw); }
double surplus_of(double imbalance_mw) { return std::max(0.0, imbalance_mw); }

/// Formula since 22 May 2024, without alpha.
double mean_price(const ImbalanceState& state) {
  const double first_up = state.marginal_incremental_eur_per_mwh -
                          kUpwardEurPerMwhPerMw * shortage_of(state.system_imbalance_mw);
  const double first_down = state.marginal_decremental_eur_per_mwh +
                            kDownwardEurPerMwhPerMw * surplus_of(state.system_imbalance_mw);
  if (std::fabs(state.system_imbalance_mw) <= kDeadBandMw) return (first_up + first_down) / 2;
  return is_short(state.system_imbalance_mw)
             ? std::max(
                   {(first_up + state.marginal_incremental_eur_per_mwh) / 2, first_up, first_down})
             : std::min({(first_down + state.marginal_decremental_eur_per_mwh) / 2, first_up,
                         first_down});
}

double price_of(PriceFormula formula, const ImbalanceState& state) {
  if (formula == PriceFormula::kMarginal) return imbalance_price_eur_per_mwh(state);
  const double alpha = formula == PriceFormula::kMean ? 0 : alpha_eur_per_mwh(state);
  const double sign = is_short(state.system_imbalance_mw) ? 1 : -1;
  return mean_price(state) + sign * alpha;
}

/// One battery of a part: the run of workstation/data/env/evaluate.cpp without minimum run time and
/// fade.
class PartRunner {
 public:
  PartRunner(const FleetPart& part, const FleetOptions& options)
      : part_(part), options_(options), soc_frac_(options.initial_soc_frac) {
    evaluation_.capacity_mwh = options.battery.capacity_wh / kWattsPerMegawatt;
    evaluation_.wear_eur_per_mwh = options.battery.wear_eur_per_mwh;
  }

  /// Decides at the start of minute `t`; `prices` contains all earlier rows.
  void decide(std::size_t t, const MinuteSeries& prices) {
    const int late = part_.late_min % kMinutesPerStep;
    if (static_cast<int>(t % kMinutesPerStep) != late) return;
    const std::int64_t row =
        static_cast<std::int64_t>(t) - options_.observation_delay_min - (part_.late_min - late);
    if (row < 0 || t + 1 >= prices.size()) return void(power_w_ = 0);
    const MarketStep step = step_at(t, static_cast<std::size_t>(row), prices);
    const BatteryParameters& battery = options_.battery;
    Action action = part_.policy->decide(step, steps_.size(), soc_frac_);
    if (is_used_up(local_date_of(step.utc_s))) action = Action::kIdle;
    const double wanted_w =
        ordered_power_w(battery, step, action, part_.policy->power_share_max(step, soc_frac_));
    const double change_w = part_.step_share * battery.power_w_max;
    const auto [moved, power] = response_step(
        battery, soc_frac_, power_, std::clamp(wanted_w, power_w_ - change_w, power_w_ + change_w),
        kHoursPerStep);
    steps_.push_back({t, action, moved.power_w, moved.soc_frac});
    day_energy_mwh_ += std::fabs(moved.power_w / kWattsPerMegawatt * kHoursPerStep);
    power_ = power;
    power_w_ = moved.power_w;
    soc_frac_ = moved.soc_frac;
  }

  /// Present export, as a share of the rated power.
  [[nodiscard]] double given_share() const {
    return -power_w_ / options_.battery.power_w_max * part_.share;
  }

  /// Profit, once every quarter-hour is settled.
  Evaluation settled(const MinuteSeries& prices) && {
    const BatteryParameters& battery = options_.battery;
    double soc_frac = options_.initial_soc_frac;
    Action before = Action::kIdle;
    for (const Step& step : steps_) {
      const std::string date = format_local_date(local_date_of(prices.utc_s(step.minute)));
      if (evaluation_.days.empty() || evaluation_.days.back().date != date) {
        evaluation_.days.push_back({date, 0, 0, 0, soc_frac});
        evaluation_.days.back().soc_start_frac = soc_frac;
      }
      DayResult& day = evaluation_.days.back();
      const double paid = 0.5 * (prices.settled[step.minute] + prices.settled[step.minute + 1]);
      const double mwh = step.power_w / kWattsPerMegawatt * kHoursPerStep;
      day.profit_eur += step_profit_eur(battery, mwh, kHoursPerStep, paid);
      day.throughput_mwh += std::fabs(mwh);
      day.switches += step.action != before ? 1 : 0;
      day.soc_end_frac = soc_frac = step.soc_frac;
      before = step.action;
    }
    for (DayResult& day : evaluation_.days) {
      day.cycles = day.throughput_mwh / (2 * battery.capacity_wh / kWattsPerMegawatt);
    }
    return std::move(evaluation_);
  }

 private:
  struct Step {
    std::size_t minute;
    Action action;
    double power_w, soc_frac;
  };

  /// True when the full cycles of the day are used up.
  bool is_used_up(const LocalDate& date) {
    if (date != day_) day_energy_mwh_ = 0;
    day_ = date;
    const BatteryParameters& battery = options_.battery;
    return battery.cycles_per_day_max > 0 && day_energy_mwh_ >= battery.cycles_per_day_max * 2 *
                                                                    battery.capacity_wh /
                                                                    kWattsPerMegawatt;
  }

  /// As in make_market_steps(), without the paid price.
  MarketStep step_at(std::size_t t, std::size_t row, const MinuteSeries& prices) {
    const double observed = prices.indicative[row];
    level_.observe(prices.utc_s(row), price_centi_of(observed));
    const LocalMinute local = local_minute_of(prices.utc_s(t));
    return {
        .utc_s = prices.utc_s(t),
        .observed_eur_per_mwh = observed,
        .paid_eur_per_mwh = kNotPublished,
        .level_centi_eur_per_mwh = level_.centi_eur_per_mwh(),
        .observed_age_min = static_cast<std::int16_t>(t - row),
        .minute_of_quarter_hour = static_cast<std::int8_t>(local.minute_of_quarter_hour),
        .quarter_hour = static_cast<std::int8_t>(local.quarter_hour),
        .month = static_cast<std::int8_t>(local.month),
        .half_hour_phase = static_cast<std::int8_t>(local.minute_of_day % 30 / kMinutesPerStep)};
  }

  const FleetPart& part_;
  const FleetOptions& options_;
  double soc_frac_;
  double power_w_ = 0;  ///< mean of the step
  PowerState power_;    ///< at its end
  LocalDate day_{};
  double day_energy_mwh_ = 0;
  PriceLevel level_;
  std::vector<Step> steps_;
  Evaluation evaluation_;
};

}  // namespace

DrawnMarket draw_market(std::int64_t start_utc_s, int days, std::uint64_t seed) {
  const std::int64_t end_utc_s = local_midnight_utc_s(add_days(local_date_of(start_utc_s), days));
  DrawnMarket market{simulate_quarter_hours({start_utc_s, end_utc_s}, seed), {}};
  MinutePathGenerator generator(seed);
  for (const QuarterHour& q : market.quarter_hours) market.paths.push_back(generator.draw(q));
  return market;
}

double fleet_price(PriceFormula formula, const MinutePath& path, int minute, bool settled_short,
                   double fleet_mw, double previous_fleet_mw) {
  const double alone_mw = path.imbalance_mw[minute];
  const double imbalance_mw = alone_mw + fleet_mw;
  const double incremental =
      path.incremental_eur_per_mwh[minute] +
      kUpwardEurPerMwhPerMw * (shortage_of(imbalance_mw) - shortage_of(alone_mw));
  const double decremental =
      path.decremental_eur_per_mwh[minute] -
      kDownwardEurPerMwhPerMw * (surplus_of(imbalance_mw) - surplus_of(alone_mw));
  const double previous_mw = path.previous_imbalance_mw + previous_fleet_mw;
  const bool is_last = minute + 1 == kMinutesPerQuarterHour;
  double price =
      price_of(formula, {imbalance_mw, minute == 0 ? 0 : previous_mw, incremental, decremental});
  if (is_last || is_short(imbalance_mw) == settled_short) price += path.unexplained_eur_per_mwh;
  return in_cents(price);
}

FleetRun run_fleet(const DrawnMarket& market, const std::vector<FleetPart>& fleet,
                   const FleetOptions& options) {
  FleetRun run;
  const std::size_t count = market.paths.size() - options.first_quarter_hour;
  run.prices.start_utc_s = market.quarter_hours[options.first_quarter_hour].utc_s;
  run.prices.indicative.assign(count * kMinutesPerQuarterHour, kNotPublished);
  run.prices.settled = run.prices.indicative;
  std::vector<PartRunner> parts;
  for (const FleetPart& part : fleet) parts.emplace_back(part, options);
  double previous_mw = 0;
  for (std::size_t q = 0; q < count; ++q) {
    const MinutePath& path = market.paths[options.first_quarter_hour + q];
    const bool settled_short = is_short(path.imbalance_mw.back());
    double sum_mw = 0, mean_mw = 0;
    for (int m = 0; m < kMinutesPerQuarterHour; ++m) {
      const std::size_t t = q * kMinutesPerQuarterHour + static_cast<std::size_t>(m);
      double given_share = 0;
      for (PartRunner& part : parts) {
        part.decide(t, run.prices);
        given_share += part.given_share();
      }
      sum_mw += given_share * options.fleet_mw;
      mean_mw = sum_mw / (m + 1);
      run.prices.indicative[t] =
          fleet_price(options.formula, path, m, settled_short, mean_mw, previous_mw);
    }
    const std::size_t first = q * kMinutesPerQuarterHour;
    std::fill_n(run.prices.settled.begin() + static_cast<std::ptrdiff_t>(first),
                kMinutesPerQuarterHour, run.prices.indicative[first + kMinutesPerQuarterHour - 1]);
    run.imbalance_mw.push_back(path.imbalance_mw.back() + mean_mw);
    previous_mw = mean_mw;
  }
  for (PartRunner& part : parts) run.parts.push_back(std::move(part).settled(run.prices));
  return run;
}

}  // namespace bess
