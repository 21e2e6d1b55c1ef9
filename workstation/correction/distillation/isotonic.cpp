#include "workstation/correction/distillation/correction_layer.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bess {
namespace {
constexpr double kNoLimit = std::numeric_limits<double>::infinity();
/// Minimum gain, relative to the sums, for a staircase to split a level set (rounding noise).
constexpr double kRelativeGain = 1e-13;
}  // namespace

IsotonicProjection::IsotonicProjection(int rows, int columns)
    : rows_(rows),
      columns_(columns),
      best_(static_cast<std::size_t>(rows) * (columns + 1)),
      argbest_(best_.size()),
      level_set_(static_cast<std::size_t>(rows) * columns) {}

IsotonicProjection::Rows IsotonicProjection::rows_of(const Block& block) const {
  int first = 0;
  int last = rows_;
  while (first < last && block.begin[first] >= block.end[first]) ++first;
  while (last > first && block.begin[last - 1] >= block.end[last - 1]) --last;
  return {first, last};
}

/// Dynamic program over rows: row i takes its cells left of t_i, and t does not increase with i.
/// Returns the largest sum of y - theta over such a staircase and its thresholds in `cut`.
double IsotonicProjection::best_staircase(const Block& block, Rows rows, double theta,
                                          int forced_in_rows, int forced_out_rows,
                                          std::vector<int>& cut) {
  const int stride = columns_ + 1;
  for (int i = rows.first; i < rows.last; ++i) {
    double* best = &best_[i * stride];
    int* argbest = &argbest_[i * stride];
    double before = i == rows.first ? 0.0 : -kNoLimit;  // best of row i-1 over thresholds >= t
    int before_at = columns_;
    double gain = 0;
    for (int j = block.begin[i]; j < block.end[i]; ++j) gain += y_[i * columns_ + j] - theta;
    for (int t = columns_; t >= 0; --t) {
      if (t < block.end[i] && t >= block.begin[i]) gain -= y_[i * columns_ + t] - theta;
      if (i > rows.first && best[t - stride] > before) {
        before = best[t - stride];
        before_at = t;
      }
      const bool allowed = (i >= forced_in_rows || t >= block.end[i]) &&
                           (i < rows_ - forced_out_rows || t <= block.begin[i]);
      best[t] = allowed ? before + gain : -kNoLimit;
      argbest[t] = before_at;
    }
  }
  const double* last = &best_[(rows.last - 1) * stride];
  int t = static_cast<int>(std::max_element(last, last + stride) - last);
  const double gain = last[t];
  cut.assign(rows_, 0);
  for (int i = rows.last - 1; i >= rows.first; --i) {
    cut[i] = t;
    t = argbest_[i * stride + t];
  }
  return gain;
}

void IsotonicProjection::split(const Block& block, const std::vector<int>& cut, Block& above,
                               Block& below) const {
  above = below = block;
  for (int i = 0; i < rows_; ++i) {
    if (block.begin[i] >= block.end[i]) continue;
    const int at = std::clamp(cut[i], block.begin[i], block.end[i]);
    above.end[i] = at;
    below.begin[i] = at;
  }
}

void IsotonicProjection::finish_level_set(const Block& block, Rows rows, double mean) {
  const double value = std::clamp(mean, block.clip_low, block.clip_high);
  const auto index = static_cast<int>(clipped_.size());
  clipped_.push_back(value != mean ? 1 : 0);
  for (int i = rows.first; i < rows.last; ++i) {
    for (int j = block.begin[i]; j < block.end[i]; ++j) {
      x_[i * columns_ + j] = value;
      level_set_[i * columns_ + j] = index;
    }
  }
}

void IsotonicProjection::solve(Block whole) {
  std::vector<Block> open{std::move(whole)};
  std::vector<int> cut;
  while (!open.empty()) {
    const Block block = std::move(open.back());
    open.pop_back();
    const Rows rows = rows_of(block);
    if (rows.first == rows.last) continue;
    double sum = 0;
    double magnitude = 0;
    int count = 0;
    for (int i = rows.first; i < rows.last; ++i) {
      for (int j = block.begin[i]; j < block.end[i]; ++j) {
        sum += y_[i * columns_ + j];
        magnitude += std::fabs(y_[i * columns_ + j]);
        ++count;
      }
    }
    const double mean = sum / count;
    const double gain = best_staircase(block, rows, mean, 0, 0, cut);
    if (gain <= kRelativeGain * magnitude) {
      finish_level_set(block, rows, mean);
      continue;
    }
    Block above, below;
    split(block, cut, above, below);
    const Rows rows_above = rows_of(above);
    const Rows rows_below = rows_of(below);
    if (rows_above.first == rows_above.last || rows_below.first == rows_below.last) {
      finish_level_set(block, rows, mean);  // a gain of the whole block is rounding of a long sum
      continue;
    }
    open.push_back(std::move(above));
    open.push_back(std::move(below));
  }
}

void IsotonicProjection::project(std::span<const double> y, const RowBounds& bounds,
                                 std::span<double> x) {
  y_ = y;
  x_ = x;
  clipped_.clear();
  std::vector<int> cut;
  Block rest{std::vector<int>(rows_, 0), std::vector<int>(rows_, columns_), -kNoLimit, kNoLimit};
  // Solves the part above the bound and keeps the rest.
  const auto split_off = [&](double bound, int forced_in_rows) {
    const Rows rows = rows_of(rest);
    if (rows.first == rows.last) return;
    best_staircase(rest, rows, bound, forced_in_rows, bounds.upper_rows, cut);
    Block above, below;
    split(rest, cut, above, below);
    above.clip_low = bound;
    below.clip_high = bound;
    solve(std::move(above));
    rest = std::move(below);
  };
  if (bounds.lower_rows > 0) split_off(bounds.lower, bounds.lower_rows);
  if (bounds.upper_rows > 0) split_off(bounds.upper, 0);
  solve(std::move(rest));
}

void IsotonicProjection::backward(std::span<const double> gradient_x,
                                  std::span<double> gradient_y) const {
  std::vector<double> mean(clipped_.size(), 0.0);
  std::vector<int> count(clipped_.size(), 0);
  for (std::size_t c = 0; c < level_set_.size(); ++c) {
    mean[level_set_[c]] += gradient_x[c];
    ++count[level_set_[c]];
  }
  for (std::size_t s = 0; s < mean.size(); ++s) mean[s] *= clipped_[s] != 0 ? 0.0 : 1.0 / count[s];
  for (std::size_t c = 0; c < level_set_.size(); ++c) gradient_y[c] = mean[level_set_[c]];
}

}  // namespace bess
