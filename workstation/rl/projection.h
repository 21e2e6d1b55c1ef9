// Categorical projection: a distribution over the support's atoms, moved to reward + discount * z,
// back onto the support [Bellemare 2017, Eq. 7]:
//   Tz_j = clip(r + gamma z_j, v_min, v_max)   b_j = (Tz_j - v_min) / step
//   m_l += p_j (u - b_j),  m_u += p_j (b_j - l)   with l = floor(b_j), u = l + 1
// Seen from the receiving atom, m_i = sum_j p_j max(0, 1 - |b_j - i|). Before clipping b_j = j + s
// - (1 - gamma) j with the reward's shift s, so only atoms at a few distances d = i - j contribute:
// two or three when gamma is near 1. Each distance is one pass over a shifted copy of p, without a
// branch or a scattered store. Measured 2026-11 (AVX-512) against the formula atom by atom: 5 times
// as fast at gamma 0.999, 2.3 to 2.7 times at 0.9; at 0.5, with half as many distances as atoms, no
// faster for 51 atoms and 1.6 times slower for 101.
#pragma once

#include <Eigen/Core>

#include "workstation/rl/support.h"

namespace bess {

class CategoricalProjection {
 public:
  /// With room for `rows` distributions.
  CategoricalProjection(const Support& support, int rows);

  /// Where distribution `row` is to be written: [padded atoms], those past the last atom zero.
  [[nodiscard]] float* distribution(int row) { return rows_.col(row).data() + margin_; }

  /// m = projection of scale * distribution(row); m is [padded atoms], zero past the last atom.
  void project(int row, float scale, float reward, float discount, float* m) const;

 private:
  Support support_;
  Eigen::Index padded_;  ///< atoms up to a whole number of panels
  Eigen::Index margin_;  ///< zeros left and right of a distribution, so that it can be read shifted
  Eigen::ArrayXf index_;  ///< 0, 1, 2, ... [padded atoms]
  Eigen::MatrixXf rows_;  ///< [margin + padded atoms + margin x rows]
};

}  // namespace bess
