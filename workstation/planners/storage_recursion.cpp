#include "workstation/planners/storage_recursion.h"

#include <Eigen/Core>

#include <algorithm>

#include "shared/exchange_cost.h"

namespace bess {
namespace {

using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
constexpr int kBins = DeviationChain::kBins;

/// value[i] = max(value[i], what is between lower[i] and upper[i], less cost)
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

}  // namespace bess
