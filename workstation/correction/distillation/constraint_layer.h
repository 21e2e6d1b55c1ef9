// Differentiable optimisation layer [Paper, Eq. 11] for general linear constraints: maps the logits
// of a batch of states to the nearest ones that satisfy a list of rows. On the paper's three
// properties (property_rows) it equals the CorrectionLayer, which is faster for those alone.
//
// Metric: sum (u-u')^2 + (v-v')^2 over the batch; the mean of a state's logits is unchanged. A
// block is a set of differences connected by rows. Each block is one dense quadratic program
// (quadratic_program.h), whose time grows with the cube of its size. Differences without rows are
// unchanged.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "shared/action.h"
#include "shared/decision_rule.h"
#include "workstation/correction/distillation/quadratic_program.h"

namespace bess {

// Linear demand on the logit differences at the states of a batch: the form of a property or an
// operator's rule that the constraint layer projects onto.
//
//   u = z_charge - z_idle     v = z_idle - z_discharge     (logits, one of each per state)
//
//   state 4 charges:             u_4 >= m             {"rule", {{4, kU, 1}}, m}
//                                v_4 >= 0             {"rule", {{4, kV, 1}}, 0}
//   state 4 does not discharge:  v_4 >= m             {"rule", {{4, kV, 1}}, m}
//   u falls from state 4 to 7:   u_4 - u_7 >= slope   {"rule", {{4, kU, 1}, {7, kU, -1}}, slope}

enum class Difference : std::uint8_t {
  kU,  ///< z_charge - z_idle
  kV,  ///< z_idle - z_discharge
};

struct DifferenceTerm {
  int state;  ///< column of the batch, 0..states-1
  Difference difference;
  double factor;
};

/// sum of factor * difference >= bound.
struct DifferenceRow {
  std::string rule;  ///< name of the rule, for reports
  std::vector<DifferenceTerm> terms;
  double bound = 0;
};

// Logits [3] of a state and their differences u = z_charge - z_idle and v = z_idle - z_discharge.
// The layers project u and v and keep the mean. z = mean + A (u, v):
//   z_dis = mean - (2v+u)/3     z_idle = mean + (v-u)/3     z_cha = mean + (v+2u)/3

/// Differences of one state, or a gradient with respect to them.
struct LogitDifferences {
  double u, v;
};

/// Differences of the state in column `c` of logits [3 x states].
inline LogitDifferences differences_of(const Eigen::MatrixXd& logits, Eigen::Index c) {
  const double idle = logits(static_cast<int>(Action::kIdle), c);
  return {logits(static_cast<int>(Action::kCharge), c) - idle,
          idle - logits(static_cast<int>(Action::kDischarge), c)};
}

/// Sets column `c` of `logits` to the logits with this mean and these differences.
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

/// Column `c` of dL/dlogits, from that of the corrected logits (the mean is unchanged) and from
/// dL/d(u, v) of the differences that entered the layer.
inline void set_logit_gradient(const Eigen::MatrixXd& gradient_corrected,
                               const LogitDifferences& difference, Eigen::MatrixXd& gradient,
                               Eigen::Index c) {
  // d mean / d z' = 1/3 each, dL/d mean = sum of the gradient
  const double mean = gradient_corrected.col(c).mean();
  gradient(static_cast<int>(Action::kDischarge), c) = mean - difference.v;
  gradient(static_cast<int>(Action::kIdle), c) = mean + difference.v - difference.u;
  gradient(static_cast<int>(Action::kCharge), c) = mean + difference.u;
}

class ConstraintLayer {
 public:
  /// For batches of `states` columns. Throws UserError, naming the rule, for a state outside the
  /// batch or a number that is not finite.
  ConstraintLayer(std::vector<DifferenceRow> rows, int states);

  /// Corrects logits [3 x states]. Throws UserError naming the rules when rows contradict each
  /// other.
  void forward(const Eigen::MatrixXd& logits, Eigen::MatrixXd& corrected);
  /// dL/dlogits from dL/dcorrected at the last forward.
  void backward(const Eigen::MatrixXd& gradient_corrected, Eigen::MatrixXd& gradient_logits);

 private:
  /// Differences connected by rows, and their projection.
  struct Block {
    std::vector<int> variables;  ///< 2 * state + (v ? 1 : 0)
    std::vector<std::size_t> rows;
    std::unique_ptr<QuadraticProgram> program;
    Eigen::VectorXd point, gradient;
  };
  void add_block(const std::vector<std::size_t>& rows);
  /// Projects into block.program->x(); throws UserError naming the rules of infeasible rows.
  void project(Block& block) const;
  /// Names the rules of a minimal infeasible set of rows: without any one of them the others can be
  /// satisfied.
  [[nodiscard]] std::string contradiction(const Block& block) const;

  std::vector<DifferenceRow> rows_;
  std::vector<Block> blocks_;
  Eigen::VectorXd differences_;  ///< [2 * states] u and v of state 0, of state 1, ...
};

// Allowed actions as linear constraints on the scores of one state [SPEC 5], u = z_charge - z_idle
// and v = z_idle - z_discharge:
//   at least charge  u >= m, v >= 0          at most discharge  -v >= m, -u >= 0
//   at least idle    v >= m                  at most idle       -u >= m
// Each is slightly stronger than necessary and separates u from v. "Not idle" is not convex: the
// constraint takes the side of the present scores.

/// on_u * u + on_v * v >= at_least.
struct ScoreRow {
  double on_u, on_v, at_least;
};

class ScoreRows {
 public:
  /// `u`, `v`: the present scores, used for "not idle" only.
  ScoreRows(ActionSet actions, double u, double v, double margin) {
    const bool discharges = allows(actions, Action::kDischarge);
    const bool idles = allows(actions, Action::kIdle);
    const bool charges = allows(actions, Action::kCharge);
    const bool has_gap = discharges && charges && !idles;
    const bool is_nearer_charge = u + v >= 0;
    const bool must_charge = has_gap ? is_nearer_charge : !discharges && !idles;
    const bool must_discharge = has_gap ? !is_nearer_charge : !charges && !idles;
    if (must_charge) {
      add({1, 0, margin});
      add({0, 1, 0});
    } else if (must_discharge) {
      add({0, -1, margin});
      add({-1, 0, 0});
    } else {
      if (!discharges) add({0, 1, margin});
      if (!charges) add({-1, 0, margin});
    }
  }
  [[nodiscard]] const ScoreRow* begin() const { return rows_.data(); }
  [[nodiscard]] const ScoreRow* end() const { return rows_.data() + count_; }

 private:
  void add(const ScoreRow& row) { rows_[count_++] = row; }
  std::array<ScoreRow, 2> rows_{};
  std::size_t count_ = 0;
};

}  // namespace bess
