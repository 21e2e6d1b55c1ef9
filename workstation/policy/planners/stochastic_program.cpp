#include "workstation/policy/planners/stochastic_program.h"

#include <Eigen/Core>
#include <algorithm>

#include "shared/battery_model.h"

namespace bess {

namespace {

using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
constexpr int kBins = DeviationChain::kBins;

/// value[i] = max(value[i], value between lower[i] and upper[i] - cost)
void improve_run(const float* __restrict lower, const float* __restrict upper,
                 const float* __restrict weight, const float* __restrict energy_mwh, float cost,
                 int count, float* __restrict value) {
  for (int i = 0; i < count; ++i) {
    const float worth = lower[i] * (1 - weight[i]) + upper[i] * weight[i] - energy_mwh[i] * cost;
    value[i] = value[i] < worth ? worth : value[i];
  }
}

}  // namespace

StorageRecursion::StorageRecursion(const BatteryParameters& battery, const SocGrid& grid,
                                   double gamma)
    : battery_(battery), points_(grid.count), gamma_(gamma) {
  for (const bool is_cold : {false, true}) {
    const std::vector<GridMove> moves =
        tabulate_moves(battery, grid, is_cold ? battery.cold.power_share : 1);
    directions_[is_cold] = {make_direction(moves, Action::kDischarge, points_),
                            make_direction(moves, Action::kCharge, points_)};
  }
}

StorageRecursion::Direction StorageRecursion::make_direction(const std::vector<GridMove>& moves,
                                                             Action action, int points) {
  Direction d{};
  const GridMove* const move =
      &moves[static_cast<std::size_t>(action) * static_cast<std::size_t>(points)];
  for (int i = 0; i < points; ++i) {
    d.lower.push_back(move[i].next.index);
    d.weight.push_back(move[i].next.weight);
    d.energy_mwh.push_back(move[i].energy_mwh);
  }
  d.full_mwh = double{action == Action::kCharge ? d.energy_mwh.front() : d.energy_mwh.back()};
  const auto shift_at = [&](int i) { return move[i].next.index - i; };
  d.first = d.end = points / 2;
  d.shift = shift_at(d.first);
  while (d.first > 0 && shift_at(d.first - 1) == d.shift) --d.first;
  while (d.end < points && shift_at(d.end) == d.shift) ++d.end;
  return d;
}

void StorageRecursion::improve(const Direction& d, double price_eur_per_mwh, const float* ahead,
                               float* value) const {
  const auto cost =
      static_cast<float>(exchange_cost_eur(battery_, d.full_mwh, price_eur_per_mwh) / d.full_mwh);
  const auto improve_from = [&](int first, const float* lower, int count) {
    improve_run(lower, lower + 1, &d.weight[static_cast<std::size_t>(first)],
                &d.energy_mwh[static_cast<std::size_t>(first)], cost, count, value + first);
  };
  const auto improve_each = [&](int first, int end) {
    for (int i = first; i < end; ++i)
      improve_from(i, ahead + d.lower[static_cast<std::size_t>(i)], 1);
  };
  improve_each(0, d.first);
  improve_from(d.first, ahead + d.first + d.shift, d.end - d.first);
  improve_each(d.end, points_);
}

void StorageRecursion::step_back(const DeviationChain& chain, int phase, int quarter_hour,
                                 double usual_eur_per_mwh, float* ahead_eur,
                                 float* value_eur) const {
  Eigen::Map<Rows> ahead(ahead_eur, kBins, points_);
  Eigen::Map<Rows> value(value_eur, kBins, points_);
  const Eigen::Map<const Rows> transition(chain.transition(phase), kBins, kBins);
  ahead.noalias() = static_cast<float>(gamma_) * (transition * value);
  value = ahead;  // idle
  for (int b = 0; b < kBins; ++b) {
    const double price = chain.paid(phase, b) + usual_eur_per_mwh;
    for (const Direction& direction : directions_[battery_.cold.hold(quarter_hour)]) {
      improve(direction, price, &ahead(b, 0), &value(b, 0));
    }
  }
}

namespace {

constexpr int kDays = 4;  ///< of backward induction: greedy actions have converged

int step_of_day(const MarketStep& step) {
  return (step.quarter_hour * kMinutesPerQuarterHour + step.minute_of_quarter_hour) /
         kMinutesPerStep;
}

/// Quarter-hour in which the step begins.
int quarter_hour_of(int step) { return step * kMinutesPerStep / kMinutesPerQuarterHour; }

/// Starts of the two minutes of a step, which may lie in different quarter-hours.
std::array<int, 2> paid_quarter_hours(int step) {
  const int minute = step * kMinutesPerStep;
  return {minute / kMinutesPerQuarterHour, (minute + 1) / kMinutesPerQuarterHour};
}

}  // namespace

StochasticProgram::StochasticProgram(const MarketSteps& market, const std::vector<MarketDay>& days,
                                     const BatteryParameters& battery, double level_weight)
    : battery_(battery), level_weight_(level_weight), grid_(battery, kSocPoints) {
  require_training_days(days.size());
  fit_usual(market, days);
  fit_chain(market, days);
  solve();
}

void StochasticProgram::save(BinaryWriter& out) const {
  out.put(battery_);
  out.put(level_weight_);
  out.put(gamma_);
  out.put(level_mean_);
  out.put(usual_);
  out.put(row_age_);
  out.put_list(levels_);
  chain_.save(out);
}

StochasticProgram::StochasticProgram(BinaryReader& in)
    : battery_(in.take<BatteryParameters>()), grid_(battery_, kSocPoints) {
  level_weight_ = in.take<double>();
  gamma_ = in.take<double>();
  level_mean_ = in.take<double>();
  usual_ = in.take<decltype(usual_)>();
  row_age_ = in.take<decltype(row_age_)>();
  levels_ = in.take_list<double>();
  chain_ = DeviationChain(in);
  if (levels_.empty()) in.damaged("has a stochastic program of another size");
  solve();
}

StochasticProgram::MarketState StochasticProgram::market_state_of(const MarketStep& step) {
  return {.step_of_day = step_of_day(step),
          .row_quarter_hour = step.row_quarter_hour(),
          .price_eur_per_mwh = step.observed_eur_per_mwh,
          .level_eur_per_mwh = step.level_eur_per_mwh()};
}

double StochasticProgram::usual(int quarter_hour, double level) const {
  return usual_[static_cast<std::size_t>(quarter_hour)] + level_weight_ * (level - level_mean_);
}

double StochasticProgram::usual_paid(int step, double level) const {
  const auto [first, second] = paid_quarter_hours(step);
  return 0.5 * (usual(first, level) + usual(second, level));
}

void StochasticProgram::fit_usual(const MarketSteps& market, const std::vector<MarketDay>& days) {
  MeanByQuarterHour paid;
  std::array<std::array<int, 2>, kMinutesPerQuarterHour> age_count{};
  for_each_step(market, days, [&](const MarketStep& step) {
    ++age_count[step.minute_of_quarter_hour][step.quarter_hours_ago() > 0 ? 1 : 0];
    paid.add(step.quarter_hour, step.paid_eur_per_mwh);
  });
  for (int minute = 0; minute < kMinutesPerQuarterHour; ++minute) {
    row_age_[minute] = age_count[minute][1] > age_count[minute][0] ? 1 : 0;
  }
  usual_ = paid.smoothed(kHourSmoothing);
  PriceLevels fitted = fit_levels(market, days, kLevelCount);
  level_mean_ = fitted.mean;
  levels_ = std::move(fitted.levels);
}

void StochasticProgram::fit_chain(const MarketSteps& market, const std::vector<MarketDay>& days) {
  std::vector<DeviationChain::Sample> samples;
  std::int64_t follows_utc_s = 0;
  for_each_step(market, days, [&](const MarketStep& step) {
    const MarketState at = market_state_of(step);
    const double level = at.level_eur_per_mwh;
    samples.push_back(
        {step.half_hour_phase, at.price_eur_per_mwh - usual(at.row_quarter_hour, level),
         step.paid_eur_per_mwh - usual_paid(at.step_of_day, level), step.utc_s == follows_utc_s});
    follows_utc_s = step.utc_s + kSecondsPerStep;
  });
  chain_ = DeviationChain(samples, kBinSmoothing);
}

void StochasticProgram::solve() {
  const StorageRecursion recursion(battery_, grid_, gamma_);
  continuation_.assign(levels_.size() * kStepsPerDay * kBins * kSocPoints, 0.0F);
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    std::vector<float> value(std::size_t{kBins} * kSocPoints, 0.0F);
    for (int step = kDays * kStepsPerDay - 1; step >= 0; --step) {
      const int of_day = step % kStepsPerDay;
      recursion.step_back(
          chain_, of_day % kPhases, quarter_hour_of(of_day), usual_paid(of_day, levels_[l]),
          &continuation_[continuation_at(static_cast<int>(l), of_day, 0)], value.data());
    }
  }
}

StochasticProgram::Outlook StochasticProgram::outlook(const MarketState& at) const {
  const double level = at.level_eur_per_mwh;
  const BinPosition bins = chain_.between(at.price_eur_per_mwh - usual(at.row_quarter_hour, level));
  const BinPosition anchors = between_levels(levels_, level);
  const int phase = at.step_of_day % kPhases;
  Outlook outlook{};
  outlook.price_eur_per_mwh = chain_.paid(phase, bins) + usual_paid(at.step_of_day, level);
  for (int l = 0; l < 2; ++l) {
    const double level_weight = l == 0 ? 1 - anchors.weight : anchors.weight;
    if (level_weight == 0) continue;
    for (int b = 0; b < 2; ++b) {
      const std::size_t i = 2 * l + b;
      outlook.row[i] = continuation_at(anchors.lower + l, at.step_of_day, bins.lower + b);
      outlook.weight[i] = level_weight * (b == 0 ? 1 - bins.weight : bins.weight);
    }
  }
  return outlook;
}

std::array<double, kActionCount> StochasticProgram::action_values(const MarketState& at,
                                                                  double soc_frac) const {
  const Outlook sees = outlook(at);
  const double full_w = battery_.power_w_at(quarter_hour_of(at.step_of_day));
  std::array<double, kActionCount> worth{};
  for (int a = 0; a < kActionCount; ++a) {
    const double wanted_w = power_sign(static_cast<Action>(a)) * full_w;
    const BatteryStep moved = battery_step(battery_, soc_frac, wanted_w, kHoursPerStep);
    const SocGrid::Position soc = grid_.position(moved.soc_frac);
    double ahead = 0;
    for (std::size_t i = 0; i < sees.row.size(); ++i) {
      if (sees.weight[i] == 0) continue;
      ahead += sees.weight[i] * double{interpolate(&continuation_[sees.row[i]], soc)};
    }
    worth[a] =
        ahead - exchange_cost_eur(battery_, moved.power_w / kWattsPerMegawatt * kHoursPerStep,
                                  sees.price_eur_per_mwh);
  }
  return worth;
}

double StochasticProgram::continuation(const MarketState& at, float* value_eur) const {
  const Outlook sees = outlook(at);
  for (int p = 0; p < kSocPoints; ++p) {
    double ahead = 0;
    for (std::size_t i = 0; i < sees.row.size(); ++i) {
      ahead += sees.weight[i] * double{continuation_[sees.row[i] + static_cast<std::size_t>(p)]};
    }
    value_eur[p] = static_cast<float>(ahead);
  }
  return sees.price_eur_per_mwh;
}

}  // namespace bess
