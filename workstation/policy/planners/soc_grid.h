// SoC grid: even points over the SoC window, linear interpolation of values, and tabulated results
// of each action from each point. Shared by the dynamic programs.
#pragma once

#include <algorithm>
#include <vector>

#include "shared/action.h"
#include "shared/battery_model.h"
#include "shared/units_and_limits.h"

namespace bess {

struct SocGrid {
  double low;
  double step;
  int count;

  SocGrid(const BatteryParameters& battery, int points)
      : low(battery.soc_min_frac),
        step((battery.soc_max_frac - battery.soc_min_frac) / (points - 1)),
        count(points) {}

  struct Position {
    int index;     ///< lower neighbour
    float weight;  ///< of the upper neighbour, 0..1
  };
  [[nodiscard]] Position position(double soc_frac) const {
    const double x = std::clamp((soc_frac - low) / step, 0.0, static_cast<double>(count - 1));
    const int index = std::min(static_cast<int>(x), count - 2);
    return {index, static_cast<float>(x - index)};
  }
  [[nodiscard]] int nearest(double soc_frac) const {
    const double x = std::clamp((soc_frac - low) / step, 0.0, static_cast<double>(count - 1));
    return static_cast<int>(x + 0.5);
  }
  [[nodiscard]] double at(int index) const { return low + step * index; }
};

template <typename T>
float interpolate(const T* value, SocGrid::Position p) {
  return static_cast<float>(value[p.index]) * (1 - p.weight) +
         static_cast<float>(value[p.index + 1]) * p.weight;
}

/// Result of one action from one grid point.
struct GridMove {
  SocGrid::Position next;
  float energy_mwh;  ///< grid side, charge positive
};

/// [action][point], for a share of the power.
inline std::vector<GridMove> tabulate_moves(const BatteryParameters& battery, const SocGrid& grid,
                                            double power_share = 1) {
  std::vector<GridMove> moves;
  for (int a = 0; a < kActionCount; ++a) {
    const double wanted_w = power_sign(static_cast<Action>(a)) * battery.power_w_max * power_share;
    for (int i = 0; i < grid.count; ++i) {
      const BatteryStep moved = battery_step(battery, grid.at(i), wanted_w, kHoursPerStep);
      moves.push_back(
          {grid.position(moved.soc_frac), static_cast<float>(moved.power_w / 1e6 * kHoursPerStep)});
    }
  }
  return moves;
}

}  // namespace bess
