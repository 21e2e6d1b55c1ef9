#include "workstation/planners/bellman_sweep.h"

#include <cmath>

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
  // The bound's own neighbours go through the table: full power ends exactly on or beyond them.
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

}  // namespace bess
