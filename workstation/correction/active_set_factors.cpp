#include "workstation/correction/active_set_factors.h"

#include <cmath>

namespace bess {

ActiveSetFactors::ActiveSetFactors(const Eigen::MatrixXd& inverse_root_transposed)
    : start_(inverse_root_transposed),
      transposed_(inverse_root_transposed),
      triangle_(start_.rows(), start_.rows()),
      reflector_(start_.rows()),
      along_(start_.rows()),
      rotations_(2, start_.rows()) {}

void ActiveSetFactors::reset() {
  transposed_ = start_;
  active_ = 0;
}

void ActiveSetFactors::direction(const Eigen::VectorXd& d, Eigen::VectorXd& z) const {
  const Eigen::Index free = size() - active_;
  z.noalias() = transposed_.bottomRows(free).transpose() * d.tail(free);
}

void ActiveSetFactors::project_free(const Eigen::VectorXd& v, Eigen::VectorXd& free) {
  const Eigen::Index count = size() - active_;
  along_.tail(count).noalias() = transposed_.bottomRows(count) * v;
  free.noalias() = transposed_.bottomRows(count).transpose() * along_.tail(count);
}

double ActiveSetFactors::independence(const Eigen::VectorXd& d) const {
  return d.tail(size() - active_).norm();
}

void ActiveSetFactors::solve(const Eigen::VectorXd& d, Eigen::VectorXd& r) const {
  r.head(active_) = d.head(active_);
  triangle_.topLeftCorner(active_, active_)
      .triangularView<Eigen::Upper>()
      .solveInPlace(r.head(active_));
}

void ActiveSetFactors::solve_transposed(Eigen::VectorXd& y) const {
  triangle_.topLeftCorner(active_, active_)
      .transpose()
      .triangularView<Eigen::Lower>()
      .solveInPlace(y.head(active_));
}

void ActiveSetFactors::add_combination(const Eigen::VectorXd& y, Eigen::VectorXd& x) const {
  x.noalias() += transposed_.topRows(active_).transpose() * y.head(active_);
}

/// d2 becomes (corner, 0, ..., 0) by I - 2 w w' / w'w with w = d2 - corner e1. J2 w = z - corner J2 e1
/// is at hand, so that J2 changes by one outer product.
void ActiveSetFactors::add(const Eigen::VectorXd& d, const Eigen::VectorXd& z) {
  const Eigen::Index free = size() - active_;
  const double first = d[active_];
  const double norm = independence(d);
  const double corner = first > 0 ? -norm : norm;
  auto w = reflector_.tail(free);
  w = d.tail(free);
  w[0] = first - corner;
  along_ = z - corner * transposed_.row(active_).transpose();
  w /= norm * (norm + std::fabs(first));  // w'w / 2
  transposed_.bottomRows(free).noalias() -= w * along_.transpose();
  triangle_.col(active_).head(active_) = d.head(active_);
  triangle_(active_, active_) = corner;
  ++active_;
}

void ActiveSetFactors::drop(Eigen::Index position) {
  const Eigen::Index last = active_ - 1;
  for (Eigen::Index j = position; j < last; ++j) {
    // Column j + 1 has one entry below the diagonal once it stands at j: turned away.
    triangle_.col(j).head(j + 2) = triangle_.col(j + 1).head(j + 2);
    for (Eigen::Index k = position; k < j; ++k) {
      const double upper = triangle_(k, j);
      const double lower = triangle_(k + 1, j);
      triangle_(k, j) = rotations_(0, k) * upper + rotations_(1, k) * lower;
      triangle_(k + 1, j) = rotations_(0, k) * lower - rotations_(1, k) * upper;
    }
    const double length = std::hypot(triangle_(j, j), triangle_(j + 1, j));
    rotations_(0, j) = triangle_(j, j) / length;
    rotations_(1, j) = triangle_(j + 1, j) / length;
    triangle_(j, j) = length;
  }
  for (Eigen::Index i = 0; i < size(); ++i) {
    double* column = &transposed_(0, i);
    double upper = column[position];
    for (Eigen::Index k = position; k < last; ++k) {
      const double lower = column[k + 1];
      column[k] = rotations_(0, k) * upper + rotations_(1, k) * lower;
      upper = rotations_(0, k) * lower - rotations_(1, k) * upper;
    }
    column[last] = upper;
  }
  --active_;
}

}  // namespace bess
