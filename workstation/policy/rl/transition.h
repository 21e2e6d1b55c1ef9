// Transition of one cache line, and the minibatch of a gradient step.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/battery_model.h"
#include "workstation/policy/nn/mlp.h"
#include "workstation/policy/rl/network_input.h"

namespace bess {

/// Rewards and values are learned in units of 1e4 EUR/h [SPEC 4].
inline constexpr float kRewardScale = 1e-4F;
/// Rewards refer to the paper's 4 MW battery, for any battery size.
inline constexpr float kPaperPowerMw = 4;

/// EUR over a step -> learned units.
inline double learned_per_eur(const BatteryParameters& battery) {
  return double{kPaperPowerMw} * kWattsPerMegawatt / battery.power_w_max / kHoursPerStep *
         double{kRewardScale};
}

/// Aligned, so that a random access to a large ring is one cache miss and not two.
struct alignas(64) Transition {
  float state[kNetworkInputs];
  float next_state[kNetworkInputs];
  float reward;         ///< -p * price, scaled
  std::int32_t action;  ///< Action
  std::int32_t terminal;
  /// A_program(s', a') of each next action for a residual (teacher.h), else 0; the
  /// network's own value is added to it.
  float next_advantage[kActionCount];
};
static_assert(sizeof(Transition) == 64);

/// Samples as columns, grouped by action: only the taken action's outputs have gradients, so each
/// group needs a third of the last layer. Exact, and a quarter faster.
struct MiniBatch {
  Matrix state;           ///< [5 x samples]
  Matrix next_state;      ///< [5 x samples]
  Matrix next_advantage;  ///< [3 x samples]
  Eigen::VectorXf reward;
  std::vector<std::int32_t> terminal;
  Eigen::Index group_end[kActionCount];  ///< samples of action a: group_end[a-1] .. group_end[a]

  [[nodiscard]] Eigen::Index size() const { return reward.size(); }
  [[nodiscard]] Eigen::Index group_begin(int action) const {
    return action == 0 ? 0 : group_end[action - 1];
  }
};

/// Groups the given transitions by action, stable within each group.
void fill_minibatch(std::span<const Transition> transitions, MiniBatch& batch);

}  // namespace bess
