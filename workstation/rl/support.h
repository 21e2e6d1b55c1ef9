// The support of the value distributions: evenly spaced atoms [Paper, Eq. 10], in units of 1e4
// EUR/h.
#pragma once

#include <Eigen/Core>

namespace bess {

/// z_i = v_min + i * step, i = 0 .. count-1; at least two.
struct Support {
  float v_min;
  float v_max;
  int count;
  [[nodiscard]] float step() const { return (v_max - v_min) / static_cast<float>(count - 1); }
  [[nodiscard]] float atom(int i) const { return v_min + static_cast<float>(i) * step(); }
  [[nodiscard]] Eigen::VectorXf atoms() const {
    return Eigen::VectorXf::LinSpaced(count, v_min, v_max);
  }
};

}  // namespace bess
