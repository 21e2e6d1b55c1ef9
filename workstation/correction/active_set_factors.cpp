#include "workstation/correction/active_set_factors.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bess {
namespace {

constexpr double kRounding = 4e-16;  ///< an entry of d, whose length is at most 1, below this is 0
constexpr int kTogether = 8;         ///< columns of R that drop() turns at a time
constexpr int kRowsTogether = 32;    ///< and rows of J

}  // namespace

RowImage::RowImage(Eigen::Index variables) : d(Eigen::VectorXd::Zero(variables)) {
  free.reserve(static_cast<std::size_t>(variables));
}

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

/// d without the rounding of what is 0, and what follows from it. Without branches: which are 0 follows no
/// pattern.
void ActiveSetFactors::finish(Eigen::Index from, RowImage& image) const {
  auto d = image.d.tail(size() - from);
  d = (d.array().abs() < kRounding).select(0.0, d);
  image.free.resize(static_cast<std::size_t>(size()));
  std::size_t count = 0;
  for (Eigen::Index k = active_; k < size(); ++k) {
    image.free[count] = static_cast<int>(k);
    count += image.d[k] != 0 ? 1 : 0;
  }
  image.free.resize(count);
  image.independence = image.d.tail(size() - active_).norm();
}

void ActiveSetFactors::image_of(const Eigen::VectorXd& normal, Eigen::Index from,
                                RowImage& image) const {
  const Eigen::Index count = size() - from;
  image.d.tail(count).noalias() = basis_.rightCols(count).transpose() * normal;
  finish(from, image);
}

void ActiveSetFactors::image_of(std::span<const int> variables, std::span<const double> factors,
                                double sign, Eigen::Index from, RowImage& image) const {
  const auto term = [&](std::size_t t, Eigen::Index k) {
    return sign * factors[t] * basis_(variables[t], k);
  };
  if (variables.size() == 2) {  // an order between two, which most rows are
    for (Eigen::Index k = from; k < size(); ++k) image.d[k] = term(0, k) + term(1, k);
  } else {
    for (Eigen::Index k = from; k < size(); ++k) {
      double sum = 0;
      for (std::size_t t = 0; t < variables.size(); ++t) sum += term(t, k);
      image.d[k] = sum;
    }
  }
  finish(from, image);
}

void ActiveSetFactors::direction(const RowImage& image, Eigen::VectorXd& z) const {
  const Eigen::Index count = size() - active_;
  if (2 * static_cast<Eigen::Index>(image.free.size()) > count) {
    z.noalias() = basis_.rightCols(count) * image.d.tail(count);
    return;
  }
  z.setZero();
  for (const int k : image.free) z += image.d[k] * basis_.col(k);
}

void ActiveSetFactors::project_free(const Eigen::VectorXd& v, Eigen::VectorXd& free) {
  const Eigen::Index count = size() - active_;
  scratch_.tail(count).noalias() = basis_.rightCols(count).transpose() * v;
  free.noalias() = basis_.rightCols(count) * scratch_.tail(count);
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
void ActiveSetFactors::add(RowImage& image, Eigen::VectorXd& z) {
  Eigen::VectorXd& d = image.d;
  int& most = *std::ranges::max_element(image.free, {}, [&d](int k) { return std::fabs(d[k]); });
  if (most != active_) {
    std::swap(d[most], d[active_]);
    basis_.col(most).swap(basis_.col(active_));
    if (image.free.front() != active_) most = static_cast<int>(active_);
  }
  direction(image, z);
  const double norm = image.independence;
  const double corner = d[active_] > 0 ? -norm : norm;
  scratch_ = (z - corner * basis_.col(active_)) / (norm * (norm + std::fabs(d[active_])));
  triangle_.col(active_).head(active_) = d.head(active_);
  triangle_(active_, active_) = corner;
  d[active_] -= corner;
  for (const int k : image.free) basis_.col(k) -= d[k] * scratch_;
  ++active_;
}

void ActiveSetFactors::drop(Eigen::Index position) {
  --active_;
  // Each column behind moves up and has one entry below its diagonal, which is turned away: in it by the
  // rotations of the columns before and one of its own, and in J by all of them.
  Eigen::Index k = position;
  for (; k + kTogether <= active_; k += kTogether) move_up<kTogether>(position, k);
  for (; k < active_; ++k) move_up<1>(position, k);
  Eigen::Index row = 0;
  for (; row + kRowsTogether <= size(); row += kRowsTogether) rotate<kRowsTogether>(position, row);
  for (; row < size(); ++row) rotate<1>(position, row);
}

/// Count rows of J through all rotations of a drop: what one hands to the next stays in registers.
template <int Count>
void ActiveSetFactors::rotate(Eigen::Index position, Eigen::Index row) {
  using Rows = Eigen::Array<double, Count, 1>;
  Rows carried = basis_.col(position).segment<Count>(row);
  for (Eigen::Index j = position; j < active_; ++j) {
    const Rows next = basis_.col(j + 1).segment<Count>(row);
    basis_.col(j).segment<Count>(row) = cosines_[j] * carried + sines_[j] * next;
    carried = cosines_[j] * next - sines_[j] * carried;
  }
  basis_.col(active_).segment<Count>(row) = carried;
}

/// Columns k + 1 to k + Count of R become k to k + Count - 1. Each rotation of a column waits for the one
/// before it, so the columns go through the rotations that all of them need side by side.
template <int Count>
void ActiveSetFactors::move_up(Eigen::Index position, Eigen::Index k) {
  double* const __restrict cosines = cosines_.data();
  double* const __restrict sines = sines_.data();
  double* columns[Count + 1];
  double upper[Count];
  for (int c = 0; c <= Count; ++c) columns[c] = triangle_.col(k + c).data();
  for (int c = 0; c < Count; ++c) {
    std::copy_n(columns[c + 1], position, columns[c]);
    upper[c] = columns[c + 1][position];
  }
  const auto turn = [&](int c, Eigen::Index j) {
    const double lower = columns[c + 1][j + 1];
    columns[c][j] = cosines[j] * upper[c] + sines[j] * lower;
    upper[c] = cosines[j] * lower - sines[j] * upper[c];
  };
  for (Eigen::Index j = position; j < k; ++j) {
    for (int c = 0; c < Count; ++c) turn(c, j);
  }
  for (int c = 0; c < Count; ++c) {
    for (Eigen::Index j = k; j < k + c; ++j) turn(c, j);
    const double lower = columns[c + 1][k + c + 1];
    const double length = std::sqrt(upper[c] * upper[c] + lower * lower);
    columns[c][k + c] = length;
    cosines[k + c] = upper[c] / length;
    sines[k + c] = lower / length;
  }
}

}  // namespace bess
