#include "workstation/policy/planners/foresight.h"

#include <algorithm>
#include <cmath>

#include "shared/units_and_limits.h"

namespace bess {

namespace {

/// now[i] = max(now[i], value of the SoC between from[i] and from[i + 1], less cost)
void improve_run(const float* __restrict from, float weight, float cost_eur, int count,
                 float* __restrict now) {
  const float lower_weight = 1 - weight;
  for (int i = 0; i < count; ++i) {
    const float worth = from[i] * lower_weight + from[i + 1] * weight - cost_eur;
    now[i] = now[i] < worth ? worth : now[i];
  }
}

}  // namespace

BellmanSweep::BellmanSweep(const BatteryParameters& battery, const SocGrid& grid)
    : grid_(grid),
      cold_(battery.cold),
      costs_(battery.costs),
      wear_eur_per_mwh_(static_cast<float>(battery.wear_eur_per_mwh)) {
  for (const bool is_cold : {false, true}) {
    const double share = is_cold ? cold_.power_share : 1;
    directions_[is_cold] = {make_direction(battery, Action::kDischarge, share),
                            make_direction(battery, Action::kCharge, share)};
  }
}

BellmanSweep::Direction BellmanSweep::make_direction(const BatteryParameters& battery,
                                                     Action action, double power_share) const {
  const double full_w = battery.power_w_max * power_share;
  const double full_mwh = power_sign(action) * full_w / 1e6 * kHoursPerStep;
  const double stored_wh =
      power_sign(action) * full_w * kHoursPerStep *
      (action == Action::kCharge ? battery.charge_efficiency : 1 / battery.discharge_efficiency);
  const double distance = stored_wh / battery.capacity_wh / grid_.step;
  const double whole = std::clamp(std::floor(distance), -1e6, 1e6);
  Direction d{.shift = static_cast<int>(whole),
              .weight = static_cast<float>(distance - whole),
              .energy_mwh = static_cast<float>(full_mwh),
              .first_unbounded = 0,
              .end_unbounded = 0,
              .moves = {}};
  const std::vector<GridMove> moves = tabulate_moves(battery, grid_, power_share);
  const auto row = moves.begin() + static_cast<std::ptrdiff_t>(action) * grid_.count;
  d.moves.assign(row, row + grid_.count);
  if (!has_constant_power(battery)) return d;
  // Neighbours of the bounds use the table: full power ends exactly on or beyond them.
  d.first_unbounded = std::clamp(-d.shift, 0, grid_.count);
  d.end_unbounded = std::clamp(grid_.count - 1 - d.shift, d.first_unbounded, grid_.count);
  return d;
}

void BellmanSweep::improve(const Direction& d, const float* next, float price, float wear,
                           float* now) const {
  const auto cost = [&](float energy_mwh) {
    return energy_mwh * price + std::fabs(energy_mwh) * wear;
  };
  const auto improve_bounded = [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const GridMove& move = d.moves[static_cast<std::size_t>(i)];
      now[i] = std::max(now[i], interpolate(next, move.next) - cost(move.energy_mwh));
    }
  };
  improve_bounded(0, d.first_unbounded);
  if (d.end_unbounded > d.first_unbounded) {
    improve_run(next + d.first_unbounded + d.shift, d.weight, cost(d.energy_mwh),
                d.end_unbounded - d.first_unbounded, now + d.first_unbounded);
  }
  improve_bounded(d.end_unbounded, grid_.count);
}

void BellmanSweep::run(const float* next, int quarter_hour, float price_eur_per_mwh, float* now,
                       float shadow_eur_per_mwh) const {
  std::copy(next, next + grid_.count, now);  // idle
  const float wear = wear_eur_per_mwh_ + shadow_eur_per_mwh;
  const auto market = static_cast<double>(price_eur_per_mwh);
  for (const Direction& direction : directions_[cold_.hold(quarter_hour)]) {
    const double paid_eur_per_mwh = direction.energy_mwh > 0 ? costs_.import_eur_per_mwh(market)
                                                             : costs_.export_eur_per_mwh(market);
    improve(direction, next, static_cast<float>(paid_eur_per_mwh), wear, now);
  }
}

Action best_action(const BatteryParameters& battery, const SocGrid& grid, const float* next,
                   int quarter_hour, double price_eur_per_mwh, double soc_frac) {
  float worth[kActionCount];
  for (int a = 0; a < kActionCount; ++a) {
    const double wanted_w = power_sign(static_cast<Action>(a)) * battery.power_w_at(quarter_hour);
    const BatteryStep moved = battery_step(battery, soc_frac, wanted_w, kHoursPerStep);
    const double mwh = moved.power_w / 1e6 * kHoursPerStep;
    worth[a] = interpolate(next, grid.position(moved.soc_frac)) -
               static_cast<float>(exchange_cost_eur(battery, mwh, price_eur_per_mwh));
  }
  return argmax_action(worth);
}

namespace {
constexpr std::size_t kSocPoints = 1801;
constexpr std::size_t kBlockSteps = 750;     // longest local day: one block per day
constexpr int kClockChangeQuarterHours = 4;  // local time falls back by an hour once a year

/// One past the last step of each local day: the quarter-hour of day decreases at midnight only.
std::vector<std::size_t> day_ends(std::span<const MarketStep> steps) {
  std::vector<std::size_t> ends;
  for (std::size_t i = 1; i < steps.size(); ++i) {
    const bool long_gap = steps[i].utc_s - steps[i - 1].utc_s > 12 * 3600;
    if (long_gap || steps[i].quarter_hour < steps[i - 1].quarter_hour - kClockChangeQuarterHours) {
      ends.push_back(i);
    }
  }
  ends.push_back(steps.size());
  return ends;
}

}  // namespace

ForesightPolicy::ForesightPolicy(const BatteryParameters& battery)
    : battery_(battery), grid_(battery, kSocPoints), sweep_(battery, grid_) {}

void ForesightPolicy::begin(std::span<const MarketStep> ahead, double soc_frac) {
  paid_.clear();
  quarter_hour_.clear();
  for (const MarketStep& step : ahead) {
    paid_.push_back(static_cast<float>(step.paid_eur_per_mwh));
    quarter_hour_.push_back(step.quarter_hour);
  }
  shadow_.assign(paid_.size(), 0.0F);
  if (battery_.cycles_per_day_max > 0) find_shadow_prices(ahead, soc_frac);
  plan();
}

void ForesightPolicy::plan() {
  const std::size_t blocks = (paid_.size() + kBlockSteps - 1) / kBlockSteps;
  border_.assign((blocks + 1) * kSocPoints, 0.0F);
  value_.resize((kBlockSteps + 1) * kSocPoints);
  for (std::size_t block = blocks; block-- > 0;) {
    solve_block(block);
    // Only differences between SoCs matter; relative to the empty battery they stay small enough
    // for float a year ahead.
    for (std::size_t i = 0; i < kSocPoints; ++i) {
      border_[block * kSocPoints + i] = value_[i] - value_[0];
    }
  }
}

/// All days together: plan with their trial prices, run the plan, and report to each day whether it
/// met its limit.
void ForesightPolicy::find_shadow_prices(std::span<const MarketStep> ahead, double soc_frac) {
  std::vector<std::size_t> ends = day_ends(ahead);
  std::vector<ShadowPrice> prices(ends.size());
  const auto set_shadow = [&](auto price_of) {
    std::size_t step = 0;
    for (std::size_t day = 0; day < ends.size(); ++day) {
      for (; step < ends[day]; ++step) shadow_[step] = static_cast<float>(price_of(prices[day]));
    }
  };
  const double energy_mwh_max =
      battery_.cycles_per_day_max * 2 * battery_.capacity_wh / kWattsPerMegawatt;
  for (int trial = 0; trial <= kShadowPriceBisections; ++trial) {
    set_shadow([](const ShadowPrice& price) { return price.trial(); });
    plan();
    double soc = soc_frac;
    std::size_t step = 0;
    for (std::size_t day = 0; day < ends.size(); ++day) {
      double energy_mwh = 0;
      for (; step < ends[day]; ++step) {
        const double wanted_w =
            power_sign(decide(ahead[step], step, soc)) * battery_.power_w_at(quarter_hour_[step]);
        const BatteryStep moved = battery_step(battery_, soc, wanted_w, kHoursPerStep);
        energy_mwh += std::fabs(moved.power_w) / kWattsPerMegawatt * kHoursPerStep;
        soc = moved.soc_frac;
      }
      prices[day].learn(energy_mwh <= energy_mwh_max);
    }
  }
  set_shadow([](const ShadowPrice& price) { return price.found(); });
}

void ForesightPolicy::solve_block(std::size_t block) const {
  const std::size_t first = block * kBlockSteps;
  const std::size_t count = std::min(kBlockSteps, paid_.size() - first);
  std::copy_n(&border_[(block + 1) * kSocPoints], kSocPoints, &value_[count * kSocPoints]);
  for (std::size_t t = count; t-- > 0;) {
    sweep_.run(&value_[(t + 1) * kSocPoints], quarter_hour_[first + t], paid_[first + t],
               &value_[t * kSocPoints], shadow_[first + t]);
  }
  solved_block_ = block;
}

BatteryParameters ForesightPolicy::shadowed(std::size_t index) const {
  BatteryParameters battery = battery_;
  battery.wear_eur_per_mwh += static_cast<double>(shadow_[index]);
  return battery;
}

const float* ForesightPolicy::values_after(std::size_t index) const {
  if (index / kBlockSteps != solved_block_) solve_block(index / kBlockSteps);
  return &value_[(index % kBlockSteps + 1) * kSocPoints];
}

Action ForesightPolicy::decide(const MarketStep&, std::size_t index, double soc_frac) const {
  return best_action(shadowed(index), grid_, values_after(index), quarter_hour_[index],
                     static_cast<double>(paid_[index]), soc_frac);
}

double ForesightPolicy::worth_eur(std::size_t index, double soc_frac, double wanted_power_w) const {
  const double most_w = battery_.power_w_at(quarter_hour_[index]);
  const BatteryStep moved =
      battery_step(battery_, soc_frac, std::clamp(wanted_power_w, -most_w, most_w), kHoursPerStep);
  const double energy_mwh = moved.power_w / kWattsPerMegawatt * kHoursPerStep;
  return static_cast<double>(interpolate(values_after(index), grid_.position(moved.soc_frac))) -
         exchange_cost_eur(shadowed(index), energy_mwh, static_cast<double>(paid_[index]));
}

}  // namespace bess
