#include "workstation/env/foresight.h"

#include "workstation/env/soc_grid.h"

namespace bess {
namespace {
constexpr int kSocPoints = 901;
}

ForesightPolicy::ForesightPolicy(const BatteryParameters& battery) : battery_(battery) {}

void ForesightPolicy::begin(std::span<const MarketStep> day) {
  const SocGrid grid(battery_, kSocPoints);
  const std::vector<GridMove> moves = tabulate_moves(battery_, grid);
  value_.assign((day.size() + 1) * kSocPoints, 0.0F);
  for (std::size_t t = day.size(); t-- > 0;) {
    const auto price = static_cast<float>(day[t].paid_eur_per_mwh);
    const float* next = &value_[(t + 1) * kSocPoints];
    float* now = &value_[t * kSocPoints];
    for (int i = 0; i < kSocPoints; ++i) {
      float best = next[i];  // idle
      for (const Action action : {Action::kDischarge, Action::kCharge}) {
        const GridMove& move = moves[static_cast<std::size_t>(action) * kSocPoints + i];
        best = std::max(best, interpolate(next, move.next) - price * move.energy_mwh);
      }
      now[i] = best;
    }
  }
}

Action ForesightPolicy::decide(const MarketStep& step, std::size_t index, double soc_frac) const {
  const SocGrid grid(battery_, kSocPoints);
  const float* next = &value_[(index + 1) * kSocPoints];
  float worth[kActionCount];
  for (int a = 0; a < kActionCount; ++a) {
    const BatteryStep moved =
        battery_step(battery_, soc_frac, power_sign(static_cast<Action>(a)) * battery_.power_w_max,
                     kHoursPerStep);
    const double paid_eur = moved.power_w / 1e6 * kHoursPerStep * step.paid_eur_per_mwh;
    worth[a] = interpolate(next, grid.position(moved.soc_frac)) - static_cast<float>(paid_eur);
  }
  return argmax_action(worth);
}

}  // namespace bess
