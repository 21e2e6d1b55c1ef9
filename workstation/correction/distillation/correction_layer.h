// Differentiable optimisation layer [Paper, Eq. 11]: maps the student's logits on one context
// lattice (all prices x SoCs for one T_qh, qh, mo) to the nearest logits that satisfy the
// properties.
//
// Logit differences u = z_charge - z_idle and v = z_idle - z_discharge are projected separately;
// the mean of the logits is unchanged [SPEC 5]:
//   monotone (3):     u, v fall by at least a slope margin per step of price and of SoC
//   price <= low (1): u >= m and v >= 0          price >= high (2): v <= -m and u <= 0
// The slope margin keeps the order in the integer student despite rounding. It is a change of
// variables: x = u + ramp is non-increasing if u falls at least as fast as the ramp rises.
#pragma once

#include <Eigen/Core>

#include <vector>

#include "shared/price_thresholds.h"
#include "workstation/correction/distillation/isotonic.h"

namespace bess {

struct CorrectionOptions {
  PriceThresholds thresholds = {};  ///< of properties 1 and 2
  double logit_margin = 1.0;        ///< m
  double price_slope = 0.2;         ///< logits over the whole mapped price range
  double soc_slope = 0.4;           ///< logits over the whole SoC range
};

/// Axes of one lattice, ascending: prices in EUR/MWh with their network input, SoC as network input
/// 0..1.
struct LatticeAxes {
  std::vector<int> price_eur_per_mwh;
  std::vector<double> mapped_price;
  std::vector<double> soc;
};

/// Bounds on x = difference + ramp for a difference that must be at least `lower` at prices <= low
/// and at most `upper` at prices >= high. The ramp varies within a row, so the strictest cell of
/// the row sets the bound.
RowBounds ramped_bounds(const CorrectionOptions& options, const LatticeAxes& axes, double lower,
                        double upper);

class CorrectionLayer {
 public:
  CorrectionLayer(const CorrectionOptions& options, int prices, int socs);

  /// Corrects logits [3 x prices*socs] (column = price index * socs + SoC index) in double.
  void forward(const LatticeAxes& axes, const Eigen::MatrixXd& logits, Eigen::MatrixXd& corrected);
  /// dL/dlogits from dL/dcorrected for the last forward.
  void backward(const Eigen::MatrixXd& gradient_corrected, Eigen::MatrixXd& gradient_logits);

  [[nodiscard]] const CorrectionOptions& options() const { return options_; }

 private:
  void project(const LatticeAxes& axes, IsotonicProjection& projection, const RowBounds& bounds,
               std::vector<double>& difference);

  CorrectionOptions options_;
  int prices_;
  int socs_;
  IsotonicProjection projection_u_;
  IsotonicProjection projection_v_;
  std::vector<double> u_, v_, shifted_;
};

}  // namespace bess
