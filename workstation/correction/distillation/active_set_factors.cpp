#include "workstation/correction/distillation/quadratic_program.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

namespace bess {

namespace {

constexpr std::size_t kBits = 64;  ///< per word

}  // namespace

VariableGroups::VariableGroups(Eigen::Index size)
    : words_((static_cast<std::size_t>(size) + kBits - 1) / kBits),
      of_variable_(static_cast<std::size_t>(size)),
      of_column_(of_variable_.size()),
      variables_(of_variable_.size() * words_),
      columns_(variables_.size()) {
  reset();
}

void VariableGroups::reset() {
  std::iota(of_variable_.begin(), of_variable_.end(), 0);
  of_column_ = of_variable_;
  std::ranges::fill(variables_, 0);
  for (std::size_t v = 0; v < of_variable_.size(); ++v) {
    variables_[v * words_ + v / kBits] |= std::uint64_t{1} << v % kBits;
  }
  columns_ = variables_;
  count_ = static_cast<int>(of_variable_.size());
}

void VariableGroups::find(std::span<const int> variables, std::vector<int>& groups) const {
  groups.clear();
  if (count_ == 1) variables = variables.first(std::min<std::size_t>(variables.size(), 1));
  for (const int variable : variables) {
    const int group = of_variable_[static_cast<std::size_t>(variable)];
    if (std::ranges::find(groups, group) == groups.end()) groups.push_back(group);
  }
}

void VariableGroups::list_variables(std::span<const int> groups, std::vector<int>& list) const {
  enumerate(groups, variables_, 0, of_variable_.size(), list);
}

void VariableGroups::list_columns(std::span<const int> groups, Eigen::Index from, Eigen::Index end,
                                  std::vector<int>& list) const {
  enumerate(groups, columns_, static_cast<std::size_t>(from), static_cast<std::size_t>(end), list);
}

void VariableGroups::enumerate(std::span<const int> groups, const Words& members, std::size_t from,
                               std::size_t end, std::vector<int>& list) const {
  list.resize(end - from);
  if (count_ == 1 && !groups.empty()) {  // all
    std::iota(list.begin(), list.end(), static_cast<int>(from));
    return;
  }
  std::size_t count = 0;
  for (std::size_t at = from; at < end; at += kBits - at % kBits) {
    std::uint64_t left = 0;
    for (const int group : groups) {
      left |= members[static_cast<std::size_t>(group) * words_ + at / kBits];
    }
    left &= ~std::uint64_t{0} << at % kBits;
    const std::size_t first = at - at % kBits;
    if (end - first < kBits) left &= ~(~std::uint64_t{0} << (end - first));
    for (; left != 0; left &= left - 1) {
      list[count++] = static_cast<int>(first) + std::countr_zero(left);
    }
  }
  list.resize(count);
}

void VariableGroups::tie(std::span<const int> groups) {
  const int one = groups.front();
  count_ -= static_cast<int>(groups.size()) - 1;
  for (const int other : groups.subspan(1)) {
    std::ranges::replace(of_variable_, other, one);
    std::ranges::replace(of_column_, other, one);
    for (std::size_t word = 0; word < words_; ++word) {
      const auto to = static_cast<std::size_t>(one) * words_ + word;
      const auto from = static_cast<std::size_t>(other) * words_ + word;
      variables_[to] |= std::exchange(variables_[from], 0);
      columns_[to] |= std::exchange(columns_[from], 0);
    }
  }
}

void VariableGroups::swap_columns(Eigen::Index one, Eigen::Index other) {
  if (of_column(one) == of_column(other)) return;
  for (const Eigen::Index column : {one, other}) {
    const auto bit = std::uint64_t{1} << static_cast<std::size_t>(column) % kBits;
    for (const int group : {of_column(one), of_column(other)}) {
      columns_[static_cast<std::size_t>(group) * words_ +
               static_cast<std::size_t>(column) / kBits] ^= bit;
    }
  }
  std::swap(of_column_[static_cast<std::size_t>(one)], of_column_[static_cast<std::size_t>(other)]);
}

namespace {

constexpr double kRounding = 4e-16;  ///< smaller entries of d (|d| <= 1) are 0
/// J is stored by columns: reading a row takes as long as reading eight columns.
constexpr std::size_t kColumnsARow = 8;
constexpr int kTogether = 8;  ///< columns of R that drop() rotates at a time

/// Calls `visit.operator()<Count>(row)` for blocks of rows of J that fit into registers.
template <typename Visit>
void for_bundles_of_rows(Eigen::Index size, Visit visit) {
  Eigen::Index row = 0;
  for (; row + 32 <= size; row += 32) visit.template operator()<32>(row);
  for (; row + 8 <= size; row += 8) visit.template operator()<8>(row);
  for (; row < size; ++row) visit.template operator()<1>(row);
}

}  // namespace

RowImage::RowImage(Eigen::Index size) : d(Eigen::VectorXd::Zero(size)) {
  for (std::vector<int>* list : {&groups, &held, &free}) {
    list->reserve(static_cast<std::size_t>(size));
  }
}

ActiveSetFactors::ActiveSetFactors(Eigen::Index size)
    : basis_(Eigen::MatrixXd::Identity(size, size)),
      triangle_(size, size),
      groups_(size),
      scratch_(size),
      cosines_(size),
      sines_(size) {
  places_.reserve(static_cast<std::size_t>(size));
}

void ActiveSetFactors::reset() {
  basis_.setIdentity();
  groups_.reset();
  active_ = 0;
}

void ActiveSetFactors::image_of(std::span<const int> variables, std::span<const double> factors,
                                RowImage& image, bool of_free) {
  const Eigen::Index from = of_free ? active_ : 0;
  groups_.find(variables, image.groups);
  groups_.list_columns(image.groups, from, active_, image.held);
  groups_.list_columns(image.groups, active_, size(), image.free);
  const Eigen::Index count = size() - from;
  if (kColumnsARow * variables.size() > static_cast<std::size_t>(size())) {
    scratch_.setZero();
    for (std::size_t t = 0; t < variables.size(); ++t) scratch_[variables[t]] = factors[t];
    image.d.tail(count).noalias() = basis_.rightCols(count).transpose() * scratch_;
  } else {
    const auto entry = [&](int k) {
      double sum = 0;
      for (std::size_t t = 0; t < variables.size(); ++t) {
        sum += factors[t] * basis_(variables[t], k);
      }
      return sum;
    };
    image.d.tail(count).setZero();
    for (const int k : image.held) image.d[k] = entry(k);
    for (const int k : image.free) image.d[k] = entry(k);
  }
  finish(from, image);
}

/// Sets rounding errors in d to 0 and derives the rest. Without branches: the zeros follow no
/// pattern.
void ActiveSetFactors::finish(Eigen::Index from, RowImage& image) const {
  auto d = image.d.tail(size() - from);
  d = (d.array().abs() < kRounding).select(0.0, d);
  std::size_t count = 0;
  for (const int k : image.free) {
    image.free[count] = k;
    count += image.d[k] != 0 ? 1 : 0;
  }
  image.free.resize(count);
  image.independence = image.d.tail(size() - active_).norm();
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

void ActiveSetFactors::solve(const RowImage& image, Eigen::VectorXd& r) const {
  r.head(active_) = image.d.head(active_);
  for (std::size_t i = image.held.size(); i-- > 0;) {
    const int k = image.held[i];
    if (r[k] == 0) continue;
    r[k] /= triangle_(k, k);
    r.head(k) -= r[k] * triangle_.col(k).head(k);
  }
}

void ActiveSetFactors::solve(Eigen::VectorXd& y) const {
  triangle_.topLeftCorner(active_, active_)
      .triangularView<Eigen::Upper>()
      .solveInPlace(y.head(active_));
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

/// Swaps the column with the largest |d2| to the front of J2. I - 2 w w' / w'w with w = d2 - corner
/// e1 then maps d2 to (corner, 0, ..., 0), and J2 changes by the outer product of J2 w = z - corner
/// J2 e1 and 2 w / w'w. w is 0 where d2 is.
void ActiveSetFactors::add(RowImage& image, Eigen::VectorXd& z) {
  Eigen::VectorXd& d = image.d;
  int& most = *std::ranges::max_element(image.free, {}, [&d](int k) { return std::fabs(d[k]); });
  if (most != active_) {
    std::swap(d[most], d[active_]);
    basis_.col(most).swap(basis_.col(active_));
    groups_.swap_columns(most, active_);
    if (image.free.front() != active_) most = static_cast<int>(active_);
  }
  direction(image, z);
  const double norm = image.independence;
  const double corner = d[active_] > 0 ? -norm : norm;
  scratch_ = (z - corner * basis_.col(active_)) / (norm * (norm + std::fabs(d[active_])));
  triangle_.col(active_).head(active_) = d.head(active_);
  triangle_(active_, active_) = corner;
  d[active_] -= corner;
  for_bundles_of_rows(size(), [&]<int Count>(Eigen::Index row) {
    const Eigen::Array<double, Count, 1> by = scratch_.segment<Count>(row);
    for (const int k : image.free) basis_.col(k).segment<Count>(row).array() -= d[k] * by;
  });
  groups_.tie(image.groups);
  ++active_;
}

/// Each column of the group after the dropped one moves forward one place and then has one entry
/// below the diagonal. Rotations remove it: a column gets those of the columns before it and one of
/// its own, J gets all of them. Other groups are not affected. The last place becomes free and
/// moves behind the active ones.
std::span<const int> ActiveSetFactors::drop(Eigen::Index position) {
  const int group[] = {groups_.of_column(position)};
  groups_.list_columns(group, position, active_, places_);
  std::size_t k = 1;
  for (; k + kTogether <= places_.size(); k += kTogether) turn_columns<kTogether>(k);
  for (; k < places_.size(); ++k) turn_columns<1>(k);
  for_bundles_of_rows(size(), [&]<int Count>(Eigen::Index row) { turn_rows<Count>(row); });
  const int last = places_.back();
  close_gap(last);
  --active_;
  for (int behind = last + 1; behind <= active_; ++behind) places_.push_back(behind);
  return places_;
}

/// Applies all rotations of a drop to Count rows of J; the carried values stay in registers.
template <int Count>
void ActiveSetFactors::turn_rows(Eigen::Index row) {
  using Rows = Eigen::Array<double, Count, 1>;
  Rows carried = basis_.col(places_.front()).segment<Count>(row);
  for (std::size_t k = 1; k < places_.size(); ++k) {
    const double cosine = cosines_[static_cast<Eigen::Index>(k)];
    const double sine = sines_[static_cast<Eigen::Index>(k)];
    const Rows next = basis_.col(places_[k]).segment<Count>(row);
    basis_.col(places_[k - 1]).segment<Count>(row) = cosine * carried + sine * next;
    carried = cosine * next - sine * carried;
  }
  basis_.col(places_.back()).segment<Count>(row) = carried;
}

/// The columns of R at places k to k + Count - 1, k > 0, move to the places before. The rotations
/// of one column depend on each other, so Count columns are rotated in parallel.
template <int Count>
void ActiveSetFactors::turn_columns(std::size_t k) {
  const int first = places_.front();
  double* columns[Count + 1];
  double upper[Count];
  for (std::size_t c = 0; c <= Count; ++c) columns[c] = triangle_.col(places_[k + c - 1]).data();
  for (int c = 0; c < Count; ++c) {
    std::copy_n(columns[c + 1], first, columns[c]);
    upper[c] = columns[c + 1][first];
  }
  const auto turn = [&](int c, std::size_t rotation) {
    const double cosine = cosines_[static_cast<Eigen::Index>(rotation)];
    const double sine = sines_[static_cast<Eigen::Index>(rotation)];
    const double lower = columns[c + 1][places_[rotation]];
    columns[c][places_[rotation - 1]] = cosine * upper[c] + sine * lower;
    upper[c] = cosine * lower - sine * upper[c];
  };
  for (std::size_t rotation = 1; rotation < k; ++rotation) {
    for (int c = 0; c < Count; ++c) turn(c, rotation);
  }
  for (int c = 0; c < Count; ++c) {
    const std::size_t own = k + static_cast<std::size_t>(c);
    for (std::size_t rotation = k; rotation < own; ++rotation) turn(c, rotation);
    const double lower = columns[c + 1][places_[own]];
    const double length = std::sqrt(upper[c] * upper[c] + lower * lower);
    columns[c][places_[own - 1]] = length;
    cosines_[static_cast<Eigen::Index>(own)] = upper[c] / length;
    sines_[static_cast<Eigen::Index>(own)] = lower / length;
  }
}

/// Column `gap` of J, which belongs to no row of R, moves behind the active ones; those move up.
void ActiveSetFactors::close_gap(Eigen::Index gap) {
  for (Eigen::Index column = gap; column + 1 < active_; ++column) {
    basis_.col(column).swap(basis_.col(column + 1));
    groups_.swap_columns(column, column + 1);
    double* const to = triangle_.col(column).data();
    const double* const from = triangle_.col(column + 1).data();
    std::copy_n(from, gap, to);
    std::copy(from + gap + 1, from + column + 2, to + gap);
  }
}

}  // namespace bess
