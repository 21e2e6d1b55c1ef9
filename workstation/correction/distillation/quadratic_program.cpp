#include "workstation/correction/distillation/quadratic_program.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bess {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Rows have unit length, so slacks and multipliers are distances. Tolerances on them are relative
// to the size of the terms of a slack.
constexpr double kViolation = 1e-12;     ///< minimum violation of a row
constexpr double kContradiction = 1e-9;  ///< minimum contradiction of rows; below, they just meet
constexpr double kWeakly = 1e-9;         ///< smaller slacks and multipliers are 0 in the derivative
constexpr double kDrift = 1e-11;         ///< slack of active rows that requires new factors
/// Largest |d2| of a unit row that depends on the active ones; rounding leaves 1e-13 at 512
/// variables.
constexpr double kDependent = 1e-9;
/// Relative to the largest: smaller entries of r are rounding and limit no step.
constexpr double kFallingMultiplier = 1e-10;
constexpr int kRebuildsMax = 3;
/// Minimum share of nonzero factors for dense products.
constexpr double kDenseShare = 0.2;
constexpr int kStepsMaxPerRow = 50;

}  // namespace

QuadraticProgram::QuadraticProgram(LinearConstraints constraints)
    : rows_(std::move(constraints)), factors_(rows_.normals.cols()), image_(rows_.normals.cols()) {
  const Eigen::Index variables = rows_.normals.cols();
  const Eigen::Index count = rows_.normals.rows();
  for (Eigen::VectorXd* v : {&free_minimum_, &x_, &z_, &r_}) v->setZero(variables);
  active_multipliers_.setZero(variables);
  for (Eigen::VectorXd* v : {&row_scale_, &multipliers_, &slacks_}) v->setZero(count);
  active_.reserve(static_cast<std::size_t>(variables));
  clash_.reserve(static_cast<std::size_t>(variables) + 1);
  is_active_.assign(static_cast<std::size_t>(count), 0);
  neglected_.reserve(static_cast<std::size_t>(count));
  passed_over_.setZero(count);
  is_claimed_.resize(static_cast<std::size_t>(variables));
  candidates_.reserve(static_cast<std::size_t>(count));
  moved_.reserve(static_cast<std::size_t>(variables));
  scale_rows();
}

/// A row of zeros is unchanged: it is satisfied or infeasible by itself.
void QuadraticProgram::scale_rows() {
  rows_.normals.makeCompressed();
  for (int i = 0; i < rows_.normals.rows(); ++i) {
    z_.setZero();
    for (Rows::InnerIterator term(rows_.normals, i); term; ++term) {
      z_[term.col()] = term.value();
    }
    const double length = z_.norm();
    row_scale_[i] = length > 0 ? 1 / length : 1;
    for (Rows::InnerIterator term(rows_.normals, i); term; ++term) {
      term.valueRef() *= row_scale_[i];
    }
    rows_.bounds[i] *= row_scale_[i];
  }
  const auto factors = static_cast<double>(rows_.normals.nonZeros());
  if (factors > kDenseShare * static_cast<double>(rows_.normals.size())) {
    dense_ = rows_.normals;
    sizes_.setZero(rows_.normals.rows());
  } else {
    columns_ = rows_.normals;
  }
}

QuadraticOutcome QuadraticProgram::solve(const Eigen::VectorXd& g) {
  start(g);
  take_in_disjoint_rows();
  const auto steps_max = kStepsMaxPerRow * (rows_.normals.rows() + rows_.normals.cols());
  int rebuilds = 0;
  while (steps_ <= steps_max) {
    int row = most_violated();
    if (row < 0) {
      while (recompute() > kDrift * scale_ && rebuilds < kRebuildsMax) {
        rebuild();
        ++rebuilds;
      }
      row = most_violated();
      if (row < 0) {
        publish_multipliers();
        return QuadraticOutcome::kSolved;
      }
    }
    if (!take_in(row)) return QuadraticOutcome::kContradiction;
  }
  return QuadraticOutcome::kStalled;
}

void QuadraticProgram::start(const Eigen::VectorXd& g) {
  factors_.reset();
  active_.clear();
  clash_.clear();
  std::ranges::fill(is_active_, 0);
  neglected_.clear();
  passed_over_.setZero();
  steps_ = 0;
  free_minimum_ = g;
  x_ = g;
  measure();
}

/// Rows without common variables are independent: at the start each is added by itself, the most
/// violated first. The more expensive steps over all active rows begin with these.
void QuadraticProgram::take_in_disjoint_rows() {
  candidates_.clear();
  for (int row = 0; row < slacks_.size(); ++row) {
    if (slacks_[row] < -kViolation * scale_) candidates_.push_back(row);
  }
  std::ranges::sort(candidates_, std::ranges::less{}, [this](int row) { return slacks_[row]; });
  std::ranges::fill(is_claimed_, 0);
  for (const int row : candidates_) {
    if (!claim_variables(row)) continue;
    image_of(row);
    if (image_.independence <= kDependent) continue;  // a row of zeros
    const double violation = -slacks_[row];
    factors_.add(image_, z_);
    move(violation);
    activate(row, violation);
    ++steps_;
  }
}

/// False, without any claim, if another row already has one of the row's variables.
bool QuadraticProgram::claim_variables(int row) {
  for (Rows::InnerIterator term(rows_.normals, row); term; ++term) {
    if (is_claimed_[static_cast<std::size_t>(term.col())] != 0) return false;
  }
  for (Rows::InnerIterator term(rows_.normals, row); term; ++term) {
    is_claimed_[static_cast<std::size_t>(term.col())] = 1;
  }
  return true;
}

/// Slacks at x, and the size of their terms.
void QuadraticProgram::measure() {
  scale_ = std::numeric_limits<double>::min();
  if (dense_.size() > 0) {
    slacks_ = -rows_.bounds;
    slacks_.noalias() += dense_ * x_;
    sizes_ = rows_.bounds.cwiseAbs();
    for (Eigen::Index i = 0; i < x_.size(); ++i) {
      sizes_ += std::fabs(x_[i]) * dense_.col(i).cwiseAbs();
    }
    scale_ = std::max(scale_, sizes_.maxCoeff());
    return;
  }
  for (int row = 0; row < slacks_.size(); ++row) {
    double slack = -rows_.bounds[row];
    double size = std::fabs(slack);
    for (Rows::InnerIterator term(rows_.normals, row); term; ++term) {
      const double part = term.value() * x_[term.col()];
      slack += part;
      size += std::fabs(part);
    }
    slacks_[row] = slack;
    scale_ = std::max(scale_, size);
  }
}

void QuadraticProgram::image_of(int row, bool of_free) {
  const auto begin = static_cast<std::size_t>(rows_.normals.outerIndexPtr()[row]);
  const auto end = static_cast<std::size_t>(rows_.normals.outerIndexPtr()[row + 1]);
  factors_.image_of({rows_.normals.innerIndexPtr() + begin, end - begin},
                    {rows_.normals.valuePtr() + begin, end - begin}, image_, of_free);
}

double QuadraticProgram::slack_of(int row) const {
  double sum = -rows_.bounds[row];
  for (Rows::InnerIterator term(rows_.normals, row); term; ++term) {
    sum += term.value() * x_[term.col()];
  }
  return sum;
}

/// x += step z, where z is the direction of the image; updates the affected slacks. The final
/// measurement removes their rounding errors.
void QuadraticProgram::move(double step) {
  if (dense_.size() > 0) {
    z_ *= step;
    x_ += z_;
    slacks_.noalias() += dense_ * z_;
    return;
  }
  factors_.list_variables(image_, moved_);
  for (const int i : moved_) {
    const double by = step * z_[i];
    x_[i] += by;
    for (Columns::InnerIterator term(columns_, i); term; ++term) {
      slacks_[term.row()] += by * term.value();
    }
  }
}

/// The row that x violates most, or -1.
int QuadraticProgram::most_violated() const {
  if (slacks_.size() == 0) return -1;
  const double least = (slacks_ + passed_over_).minCoeff();
  if (!(least < -kViolation * scale_)) return -1;
  int worst = 0;
  while (slacks_[worst] + passed_over_[worst] != least) ++worst;
  return worst;
}

/// Largest step along -r before a multiplier reaches 0.
QuadraticProgram::Limit QuadraticProgram::limit_by_multipliers() const {
  Limit limit{kInfinity, 0};
  if (image_.held.empty()) return limit;
  const double falling = kFallingMultiplier * r_.head(factors_.active()).cwiseAbs().maxCoeff();
  for (const int k : image_.held) {
    // The rarer condition first: the sign of r is unpredictable.
    const bool is_nearer = active_multipliers_[k] < limit.step * r_[k];
    if (is_nearer && r_[k] > falling) {
      limit = {active_multipliers_[k] / r_[k], static_cast<std::size_t>(k)};
    }
  }
  return limit;
}

/// Clips rounding errors: multipliers are not negative.
void QuadraticProgram::keep_signs() {
  auto of_active = active_multipliers_.head(factors_.active());
  of_active = of_active.cwiseMax(0);
}

/// Step 2 of the paper: moves towards the row until it is tight and drops blocking active rows.
/// False if the row contradicts the active ones.
bool QuadraticProgram::take_in(int row) {
  double multiplier = 0;
  while (true) {
    ++steps_;
    image_of(row);
    factors_.solve(image_, r_);
    const double independence = image_.independence;
    const bool is_dependent = independence <= kDependent;
    const double violation = std::max(0.0, -slack_of(row));
    const double full = is_dependent ? kInfinity : violation / (independence * independence);
    const Limit limit = limit_by_multipliers();
    const double step = std::min(full, limit.step);
    if (step == kInfinity) {
      if (violation > kContradiction * scale_) {
        keep_clash(row);
        return false;
      }
      neglected_.push_back(row);
      passed_over_[row] = kInfinity;
      return true;
    }
    active_multipliers_.head(factors_.active()) -= step * r_.head(factors_.active());
    keep_signs();
    multiplier += step;
    if (full <= limit.step) {
      factors_.add(image_, z_);
      move(step);
      activate(row, multiplier);
      for (const int other : neglected_) passed_over_[other] = 0;
      neglected_.clear();
      return true;
    }
    if (!is_dependent) {
      factors_.direction(image_, z_);
      move(step);
    }
    let_go(limit.position);
  }
}

void QuadraticProgram::activate(int row, double multiplier) {
  active_multipliers_[static_cast<Eigen::Index>(active_.size())] = multiplier;
  active_.push_back(row);
  mark(row, true);
}

/// Active rows are excluded from the search for violated ones.
void QuadraticProgram::mark(int row, bool active) {
  is_active_[static_cast<std::size_t>(row)] = active ? 1 : 0;
  passed_over_[row] = active ? kInfinity : 0;
}

/// Adds the row to the factors unless it depends on the active ones.
bool QuadraticProgram::hold(int row) {
  image_of(row, true);  // most of these rows depend on the others
  if (image_.independence <= kDependent) return false;
  image_of(row);
  factors_.add(image_, z_);
  return true;
}

void QuadraticProgram::let_go(std::size_t position) {
  mark(active_[position], false);
  const std::span<const int> places = factors_.drop(static_cast<Eigen::Index>(position));
  for (std::size_t k = 1; k < places.size(); ++k) {
    active_[static_cast<std::size_t>(places[k - 1])] = active_[static_cast<std::size_t>(places[k])];
    active_multipliers_[places[k - 1]] = active_multipliers_[places[k]];
  }
  active_.pop_back();
}

/// The row is the sum of r times active ones, and no r is positive: row - sum = 0 while the bounds
/// sum to the violation. The active rows are independent, so the sum is unique: without any one of
/// these rows the others can be satisfied.
void QuadraticProgram::keep_clash(int row) {
  const double least =
      kFallingMultiplier * std::max(1.0, r_.head(factors_.active()).cwiseAbs().sum());
  clash_.push_back({row, row_scale_[row]});
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const double part = -r_[static_cast<Eigen::Index>(k)];
    if (std::fabs(part) <= least) continue;
    clash_.push_back({active_[k], part * row_scale_[active_[k]]});
  }
}

/// x and multipliers of the active set, from the factors alone:
///   y = R^-T (b - N'g)    x = g + J1 y    multipliers = R^-1 y
/// Returns the largest slack of the active rows.
double QuadraticProgram::recompute() {
  x_ = free_minimum_;
  for (std::size_t k = 0; k < active_.size(); ++k) {
    z_[static_cast<Eigen::Index>(k)] = -slack_of(active_[k]);
  }
  factors_.solve_transposed(z_);
  factors_.add_combination(z_, x_);
  factors_.solve(z_);
  measure();
  active_multipliers_.head(factors_.active()) = z_.head(factors_.active());
  keep_signs();
  double distance = 0;
  for (const int row : active_) distance = std::max(distance, std::fabs(slacks_[row]));
  return distance;
}

/// Recomputes the factors of the active set.
void QuadraticProgram::rebuild() {
  factors_.reset();
  std::erase_if(active_, [this](int row) {
    const bool held = hold(row);
    mark(row, held);
    return !held;
  });
}

void QuadraticProgram::publish_multipliers() {
  multipliers_.setZero();
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const int row = active_[k];
    multipliers_[row] = active_multipliers_[static_cast<Eigen::Index>(k)] * row_scale_[row];
  }
}

void QuadraticProgram::backward(const Eigen::VectorXd& gradient_x, Eigen::VectorXd& gradient_g) {
  const double weak = kWeakly * scale_;
  // Kept: every tight row.
  for (int row = 0; row < slacks_.size(); ++row) {
    if (is_active_[static_cast<std::size_t>(row)] != 0 || slacks_[row] > weak) continue;
    if (hold(row)) activate(row, 0);
  }
  factors_.project_free(gradient_x, gradient_g);
  // Dropped: those without a multiplier.
  const std::size_t held = active_.size();
  for (Eigen::Index k = factors_.active(); k-- > 0;) {
    if (active_multipliers_[k] <= weak) let_go(static_cast<std::size_t>(k));
  }
  if (active_.size() == held) return;
  factors_.project_free(gradient_x, z_);
  gradient_g = (gradient_g + z_) / 2;
}

}  // namespace bess
