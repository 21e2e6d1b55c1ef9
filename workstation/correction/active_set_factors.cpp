#include "workstation/correction/active_set_factors.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bess {
namespace {

void rotate(Eigen::MatrixXd::ColXpr first, Eigen::MatrixXd::ColXpr second, double cosine,
            double sine) {
  double* const __restrict a = first.data();
  double* const __restrict b = second.data();
  for (Eigen::Index i = 0; i < first.size(); ++i) {
    const double upper = a[i];
    const double lower = b[i];
    a[i] = cosine * upper + sine * lower;
    b[i] = cosine * lower - sine * upper;
  }
}

}  // namespace

ActiveSetFactors::ActiveSetFactors(const Eigen::MatrixXd& inverse_root)
    : start_(inverse_root.transpose()),
      basis_(start_),
      triangle_(start_.rows(), start_.rows()),
      scratch_(start_.rows()),
      cosines_(start_.rows()),
      sines_(start_.rows()) {}

void ActiveSetFactors::reset() {
  basis_ = start_;
  active_ = 0;
}

void ActiveSetFactors::direction(const Eigen::VectorXd& d, Eigen::VectorXd& z) const {
  z.setZero();
  for (Eigen::Index k = active_; k < size(); ++k) {
    if (d[k] != 0) z += d[k] * basis_.col(k);
  }
}

void ActiveSetFactors::project_free(const Eigen::VectorXd& v, Eigen::VectorXd& free) {
  const Eigen::Index count = size() - active_;
  scratch_.tail(count).noalias() = basis_.rightCols(count).transpose() * v;
  free.noalias() = basis_.rightCols(count) * scratch_.tail(count);
}

double ActiveSetFactors::independence(const Eigen::VectorXd& d) const {
  return d.tail(size() - active_).norm();
}

void ActiveSetFactors::solve(const Eigen::VectorXd& d, Eigen::VectorXd& r) const {
  r.head(active_) = d.head(active_);
  for (Eigen::Index j = active_ - 1; j >= 0; --j) {
    if (r[j] == 0) continue;
    r[j] /= triangle_(j, j);
    r.head(j) -= r[j] * triangle_.col(j).head(j);
  }
}

void ActiveSetFactors::solve_transposed(Eigen::VectorXd& y) const {
  triangle_.topLeftCorner(active_, active_)
      .transpose()
      .triangularView<Eigen::Lower>()
      .solveInPlace(y.head(active_));
}

void ActiveSetFactors::add_combination(const Eigen::VectorXd& y, Eigen::VectorXd& x) const {
  x.noalias() += basis_.leftCols(active_) * y.head(active_);
}

/// The column that the row meets most becomes the first of J2. Then d2 becomes (corner, 0, ..., 0) by
/// I - 2 w w' / w'w with w = d2 - corner e1, and J2 changes by the outer product of
/// J2 w = z - corner J2 e1 and 2 w / w'w: w is 0 where d2 is.
void ActiveSetFactors::add(Eigen::VectorXd& d, Eigen::VectorXd& z) {
  Eigen::Index most = 0;
  d.tail(size() - active_).cwiseAbs().maxCoeff(&most);
  most += active_;
  std::swap(d[most], d[active_]);
  basis_.col(most).swap(basis_.col(active_));

  direction(d, z);
  const double norm = independence(d);
  const double corner = d[active_] > 0 ? -norm : norm;
  scratch_ = (z - corner * basis_.col(active_)) / (norm * (norm + std::fabs(d[active_])));
  triangle_.col(active_).head(active_) = d.head(active_);
  triangle_(active_, active_) = corner;
  d[active_] -= corner;
  for (Eigen::Index k = active_; k < size(); ++k) {
    if (d[k] != 0) basis_.col(k) -= d[k] * scratch_;
  }
  ++active_;
}

void ActiveSetFactors::drop(Eigen::Index position) {
  --active_;
  // Each column behind moves up and has one entry below its diagonal, which is turned away: in it by the
  // rotations of the columns before and one of its own, and in J by all of them.
  for (Eigen::Index k = position; k < active_; ++k) {
    const double* const from = triangle_.col(k + 1).data();
    double* const to = triangle_.col(k).data();
    std::copy_n(from, position, to);
    double upper = from[position];
    for (Eigen::Index j = position; j < k; ++j) {
      const double lower = from[j + 1];
      to[j] = cosines_[j] * upper + sines_[j] * lower;
      upper = cosines_[j] * lower - sines_[j] * upper;
    }
    const double lower = from[k + 1];
    to[k] = std::hypot(upper, lower);
    cosines_[k] = upper / to[k];
    sines_[k] = lower / to[k];
  }
  for (Eigen::Index j = position; j < active_; ++j) {
    rotate(basis_.col(j), basis_.col(j + 1), cosines_[j], sines_[j]);
  }
}

}  // namespace bess
