#include "workstation/market/model/unit_autoregression.h"

#include <cmath>

namespace bess {

double UnitAutoregression::next(Random& random) {
  const double shock = random.normal();
  value_ = started_ ? correlation_ * value_ + std::sqrt(1 - correlation_ * correlation_) * shock
                    : shock;  // starts in the stationary distribution: no warm-up days
  started_ = true;
  return value_;
}

}  // namespace bess
