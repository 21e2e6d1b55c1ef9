#include "workstation/correction/distillation/constraint_layer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "shared/host/user_error.h"

namespace bess {
namespace {

int variable_of(const DifferenceTerm& term) {
  return 2 * term.state + (term.difference == Difference::kV ? 1 : 0);
}

void check_row(const DifferenceRow& row, int states) {
  if (row.terms.empty()) fail("rule \"{}\": a row without terms", row.rule);
  bool is_finite = std::isfinite(row.bound);
  for (const DifferenceTerm& term : row.terms) {
    if (term.state < 0 || term.state >= states) {
      fail("rule \"{}\": state {} is outside the batch of {}", row.rule, term.state, states);
    }
    is_finite &= std::isfinite(term.factor);
  }
  if (!is_finite) fail("rule \"{}\": a bound or factor is not a finite number", row.rule);
}

/// Union-find sets of variables.
class DisjointSets {
 public:
  explicit DisjointSets(int size) : parent_(static_cast<std::size_t>(size)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int find(int member) {
    int& parent = parent_[static_cast<std::size_t>(member)];
    if (parent != member) parent = find(parent);
    return parent;
  }
  void join(int a, int b) { parent_[static_cast<std::size_t>(find(a))] = find(b); }

 private:
  std::vector<int> parent_;
};

}  // namespace

ConstraintLayer::ConstraintLayer(std::vector<DifferenceRow> rows, int states)
    : rows_(std::move(rows)), differences_(2 * states) {
  DisjointSets sets(2 * states);
  for (const DifferenceRow& row : rows_) {
    check_row(row, states);
    for (const DifferenceTerm& term : row.terms) {
      sets.join(variable_of(term), variable_of(row.terms.front()));
    }
  }
  std::map<int, std::vector<std::size_t>> rows_of_set;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    rows_of_set[sets.find(variable_of(rows_[i].terms.front()))].push_back(i);
  }
  for (const auto& [set, members] : rows_of_set) add_block(members);
}

void ConstraintLayer::add_block(const std::vector<std::size_t>& rows) {
  Block block{.variables = {}, .rows = rows, .program = nullptr, .point = {}, .gradient = {}};
  std::map<int, int> column_of;
  for (const std::size_t i : rows) {
    for (const DifferenceTerm& term : rows_[i].terms) column_of[variable_of(term)] = 0;
  }
  for (auto& [variable, column] : column_of) {
    column = static_cast<int>(block.variables.size());
    block.variables.push_back(variable);
  }
  const auto count = static_cast<int>(rows.size());
  const auto variables = static_cast<int>(block.variables.size());
  LinearConstraints constraints;
  constraints.normals.resize(count, variables);
  constraints.bounds.resize(count);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < count; ++i) {
    const DifferenceRow& row = rows_[block.rows[static_cast<std::size_t>(i)]];
    constraints.bounds[i] = row.bound;
    for (const DifferenceTerm& term : row.terms) {
      entries.emplace_back(i, column_of.at(variable_of(term)), term.factor);
    }
  }
  constraints.normals.setFromTriplets(entries.begin(), entries.end());
  block.program = std::make_unique<QuadraticProgram>(std::move(constraints));
  block.point.resize(variables);
  block.gradient.resize(variables);
  blocks_.push_back(std::move(block));
}

void ConstraintLayer::project(Block& block) const {
  for (std::size_t i = 0; i < block.variables.size(); ++i) {
    block.point[static_cast<Eigen::Index>(i)] = differences_[block.variables[i]];
  }
  const QuadraticOutcome outcome = block.program->solve(block.point);
  if (outcome == QuadraticOutcome::kContradiction) fail("{}", contradiction(block));
  if (outcome == QuadraticOutcome::kStalled) {
    fail("rule \"{}\" and those coupled to it: factors and bounds are too badly scaled to solve",
         rows_[block.rows.front()].rule);
  }
}

std::string ConstraintLayer::contradiction(const Block& block) const {
  std::vector<std::size_t> rows;
  for (const ClashingRow& part : block.program->clash()) {
    rows.push_back(block.rows[static_cast<std::size_t>(part.row)]);
  }
  std::ranges::sort(rows);
  std::vector<std::string> rules;  // distinct, in the order of the rows
  for (const std::size_t row : rows) {
    const std::string quoted = fmt::format("\"{}\"", rows_[row].rule);
    if (std::ranges::find(rules, quoted) == rules.end()) rules.push_back(quoted);
  }
  return fmt::format("{} {} at state {} of the batch: remove one or change its bound",
                     fmt::join(rules, " and "),
                     rules.size() == 1 ? "contradicts itself" : "contradict each other",
                     rows_[rows.front()].terms.front().state);
}

void ConstraintLayer::forward(const Eigen::MatrixXd& logits, Eigen::MatrixXd& corrected) {
  for (Eigen::Index c = 0; c < logits.cols(); ++c) {
    const LogitDifferences difference = differences_of(logits, c);
    differences_[2 * c] = difference.u;
    differences_[2 * c + 1] = difference.v;
  }
  for (Block& block : blocks_) {
    project(block);
    for (std::size_t i = 0; i < block.variables.size(); ++i) {
      differences_[block.variables[i]] = block.program->x()[static_cast<Eigen::Index>(i)];
    }
  }
  corrected.resize(kActionCount, logits.cols());
  for (Eigen::Index c = 0; c < logits.cols(); ++c) {
    set_logits(logits.col(c).mean(), {differences_[2 * c], differences_[2 * c + 1]}, corrected, c);
  }
}

void ConstraintLayer::backward(const Eigen::MatrixXd& gradient_corrected,
                               Eigen::MatrixXd& gradient_logits) {
  const auto& g = gradient_corrected;
  for (Eigen::Index c = 0; c < g.cols(); ++c) {
    const LogitDifferences difference = difference_gradient_of(g, c);
    differences_[2 * c] = difference.u;
    differences_[2 * c + 1] = difference.v;
  }
  for (Block& block : blocks_) {
    for (std::size_t i = 0; i < block.variables.size(); ++i) {
      block.point[static_cast<Eigen::Index>(i)] = differences_[block.variables[i]];
    }
    block.program->backward(block.point, block.gradient);
    for (std::size_t i = 0; i < block.variables.size(); ++i) {
      differences_[block.variables[i]] = block.gradient[static_cast<Eigen::Index>(i)];
    }
  }
  gradient_logits.resize(kActionCount, g.cols());
  for (Eigen::Index c = 0; c < g.cols(); ++c) {
    set_logit_gradient(g, {differences_[2 * c], differences_[2 * c + 1]}, gradient_logits, c);
  }
}

}  // namespace bess
