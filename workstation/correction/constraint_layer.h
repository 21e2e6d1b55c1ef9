// The differentiable optimisation layer [Paper, Eq. 11] for any linear constraints: maps the logits
// of a batch of states to the nearest ones that satisfy a plain list of rows. It gives the answer
// of the CorrectionLayer on the paper's three properties (lattice_rows.h), which stays the fast way
// for those alone.
//
// Metric as there: sum (u-u')^2 + (v-v')^2 over the batch, the mean of a state's logits passes
// through. States that no row ties together are projected apart: a block is a set of differences
// connected by rows, each one dense quadratic program (quadratic_program.h), whose time grows with
// the cube of its size. A difference that is in no row stays as it is.
#pragma once

#include <Eigen/Core>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "workstation/correction/difference_row.h"
#include "workstation/correction/quadratic_program.h"

namespace bess {

/// Rows that no logits satisfy together: leave out any one of them and the others can be satisfied.
struct RowClash {
  std::vector<std::size_t> rows;   ///< indices into the layer's rows, ascending
  std::vector<std::string> rules;  ///< whose rows they are, each once, in the order of the rows
};

class ConstraintLayer {
 public:
  /// For batches of `states` columns. Throws UserError, naming the rule, for a row with a state
  /// outside the batch or a number that is not finite.
  ConstraintLayer(std::vector<DifferenceRow> rows, int states);

  /// Corrects logits [3 x states]. Throws UserError naming the rules when rows contradict each
  /// other.
  void forward(const Eigen::MatrixXd& logits, Eigen::MatrixXd& corrected);
  /// dL/dlogits from dL/dcorrected at the last forward.
  void backward(const Eigen::MatrixXd& gradient_corrected, Eigen::MatrixXd& gradient_logits);

  /// The rows that contradict each other, if any do; whether rows can be satisfied does not depend
  /// on logits.
  [[nodiscard]] std::optional<RowClash> clash();

  [[nodiscard]] const std::vector<DifferenceRow>& rows() const { return rows_; }
  /// Variables of the largest block.
  [[nodiscard]] int largest_block() const;

 private:
  /// Differences connected by rows, and their projection.
  struct Block {
    std::vector<int> variables;     ///< 2 * state + (v ? 1 : 0)
    std::vector<std::size_t> rows;  ///< equalities first, as the program wants them
    std::unique_ptr<QuadraticProgram> program;
    Eigen::VectorXd point, gradient;
  };
  void add_block(const std::vector<std::size_t>& rows);
  /// Into block.program->x(); or the rows that leave no point.
  [[nodiscard]] std::optional<RowClash> project(Block& block) const;
  [[nodiscard]] std::string contradiction(const RowClash& clash) const;

  std::vector<DifferenceRow> rows_;
  std::vector<Block> blocks_;
  Eigen::VectorXd differences_;  ///< [2 * states] u and v of state 0, of state 1, ...
};

}  // namespace bess
