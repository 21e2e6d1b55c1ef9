// Logits [3] of a state and what the layers project: u = z_charge - z_idle and v = z_idle -
// z_discharge, while their mean passes through. z = mean + A (u, v):
//   z_dis = mean - (2v+u)/3     z_idle = mean + (v-u)/3     z_cha = mean + (v+2u)/3
#pragma once

#include <Eigen/Core>

#include "shared/action.h"

namespace bess {

/// Of one state: a point, or a gradient with respect to it.
struct LogitDifferences {
  double u, v;
};

/// Of the state in column `c` of logits [3 x states].
inline LogitDifferences differences_of(const Eigen::MatrixXd& logits, Eigen::Index c) {
  const double idle = logits(static_cast<int>(Action::kIdle), c);
  return {logits(static_cast<int>(Action::kCharge), c) - idle,
          idle - logits(static_cast<int>(Action::kDischarge), c)};
}

/// Column `c` of `logits` becomes the logits of this mean and these differences.
inline void set_logits(double mean, const LogitDifferences& difference, Eigen::MatrixXd& logits,
                       Eigen::Index c) {
  const double discharge = mean - (2 * difference.v + difference.u) / 3;
  const double idle = discharge + difference.v;
  logits(static_cast<int>(Action::kDischarge), c) = discharge;
  logits(static_cast<int>(Action::kIdle), c) = idle;
  logits(static_cast<int>(Action::kCharge), c) = idle + difference.u;
}

/// dL/d(u, v) of set_logits, from dL/dlogits in column `c`.
inline LogitDifferences difference_gradient_of(const Eigen::MatrixXd& gradient, Eigen::Index c) {
  const double discharge = gradient(static_cast<int>(Action::kDischarge), c);
  const double idle = gradient(static_cast<int>(Action::kIdle), c);
  const double charge = gradient(static_cast<int>(Action::kCharge), c);
  return {(-discharge - idle + 2 * charge) / 3, (-2 * discharge + idle + charge) / 3};
}

/// Column `c` of dL/dlogits, from that of the corrected logits, whose mean passed through, and from
/// dL/d(u, v) of the differences that went into the layer.
inline void set_logit_gradient(const Eigen::MatrixXd& gradient_corrected,
                               const LogitDifferences& difference, Eigen::MatrixXd& gradient,
                               Eigen::Index c) {
  // d mean / d z' = 1/3 each, dL/d mean = sum of the gradient
  const double mean = gradient_corrected.col(c).mean();
  gradient(static_cast<int>(Action::kDischarge), c) = mean - difference.v;
  gradient(static_cast<int>(Action::kIdle), c) = mean + difference.v - difference.u;
  gradient(static_cast<int>(Action::kCharge), c) = mean + difference.u;
}

}  // namespace bess
