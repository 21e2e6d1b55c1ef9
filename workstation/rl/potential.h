// Potential of a state, for shaping rewards [Ng, Harada, Russell 1999]:
//   r' = r + gamma Phi(s') - Phi(s)
// changes no decision, whatever Phi is, and what is left to learn is what Phi does not know: with
// the stochastic program's value function the network learns to correct the program, not that
// energy has a price.
#pragma once

#include <cstdint>
#include <functional>

#include "shared/battery_model.h"
#include "workstation/env/market_steps.h"

namespace bess {

enum class PotentialKind : std::uint8_t {
  kNone,
  kSdp,  ///< value of the stochastic program (planners/stochastic_program.h)
};

struct Potential {
  int soc_points = 2;
  /// Writes Phi, EUR, at `soc_points` even points of the SoC window. Sees what a policy sees.
  std::function<void(const MarketStep&, float* phi_eur)> fill = [](const MarketStep&, float* phi) {
    phi[0] = phi[1] = 0;
  };
};

/// Fits to the training days of `market`, of which there must be some.
Potential fit_potential(PotentialKind kind, const MarketSteps& market,
                        const BatteryParameters& battery);

/// Mean of Phi over the training steps at the middle of the SoC window, EUR.
double mean_of(const Potential& potential, const MarketSteps& market);

}  // namespace bess
