#include "workstation/rl/projection.h"

#include <algorithm>
#include <cmath>

#include "workstation/nn/tile_kernels.h"

namespace bess {

CategoricalProjection::CategoricalProjection(const Support& support, int rows)
    : support_(support),
      padded_(padded_to_panels(support.count)),
      margin_(padded_),
      index_(Eigen::ArrayXf::LinSpaced(padded_, 0.0F, static_cast<float>(padded_ - 1))),
      rows_(Eigen::MatrixXf::Zero(padded_ + 2 * margin_, rows)) {}

void CategoricalProjection::project(int row, float scale, float reward, float discount,
                                    float* m) const {
  const int last = support_.count - 1;
  const float* p = rows_.col(row).data() + margin_;
  const Eigen::Map<const Eigen::ArrayXf> here(p, padded_);
  Eigen::Map<Eigen::ArrayXf> result(m, padded_);

  // Atom j moves by shift - shrink * j steps, the first furthest up.
  const double shrink = 1 - double{discount};
  const double shift = (double{reward} - shrink * double{support_.v_min}) / double{support_.step()};
  const double nearest = std::max(std::floor(shift - shrink * last), -double(last));
  const double furthest = std::min(std::floor(shift) + 1, double(last));
  const auto slope = static_cast<float>(shrink);

  result.setZero();
  const auto count = static_cast<int>(std::max(0.0, furthest - nearest + 1));
  for (int n = 0; n < count; ++n) {  // b_j - i = shift - d - shrink (i - d)
    const double d = nearest + n;
    const Eigen::Map<const Eigen::ArrayXf> moved(p - static_cast<Eigen::Index>(d), padded_);
    const auto offset = static_cast<float>(shift - d + shrink * d);
    result += moved * (1 - (offset - slope * index_).abs()).max(0.0F);
  }
  result *= scale;
  // The end atoms also take what moved past them.
  const auto moves = static_cast<float>(shift) - slope * index_;
  const float low = (here * ((1 - index_) - moves).max(0.0F).min(1.0F)).sum();
  const float high =
      (here * ((index_ - static_cast<float>(last - 1)) + moves).max(0.0F).min(1.0F)).sum();
  result.tail(padded_ - support_.count).setZero();
  m[0] = scale * low;
  m[last] = scale * high;
}

}  // namespace bess
