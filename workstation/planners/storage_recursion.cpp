#include "workstation/planners/storage_recursion.h"

#include <Eigen/Core>

#include <algorithm>

#include "shared/exchange_cost.h"

namespace bess {
namespace {

using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
constexpr int kBins = DeviationChain::kBins;

}  // namespace

StorageRecursion::StorageRecursion(const BatteryParameters& battery, const SocGrid& grid,
                                   double gamma)
    : battery_(battery),
      points_(grid.count),
      gamma_(gamma),
      moves_(tabulate_moves(battery, grid)) {}

void StorageRecursion::step_back(const DeviationChain& chain, int phase, double usual_eur_per_mwh,
                                 float* ahead_eur, float* value_eur) const {
  Eigen::Map<Rows> ahead(ahead_eur, kBins, points_);
  Eigen::Map<Rows> value(value_eur, kBins, points_);
  const Eigen::Map<const Rows> transition(chain.transition(phase), kBins, kBins);
  ahead.noalias() = static_cast<float>(gamma_) * (transition * value);
  for (int b = 0; b < kBins; ++b) {
    const double price = chain.paid(phase, b) + usual_eur_per_mwh;
    value.row(b) = ahead.row(b);  // idle
    for (const Action action : {Action::kDischarge, Action::kCharge}) {
      const GridMove* move = &moves_[static_cast<int>(action) * points_];
      const auto full = static_cast<double>(
          action == Action::kCharge ? move[0].energy_mwh : move[points_ - 1].energy_mwh);
      const auto cost = static_cast<float>(exchange_cost_eur(battery_, full, price) / full);
      for (int i = 0; i < points_; ++i) {
        const float worth = interpolate(&ahead(b, 0), move[i].next) - move[i].energy_mwh * cost;
        value(b, i) = std::max(value(b, i), worth);
      }
    }
  }
}

}  // namespace bess
