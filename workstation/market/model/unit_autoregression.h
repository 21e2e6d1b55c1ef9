// First-order autoregressive process with unit variance: the memory of the simulated market.
#pragma once

#include "workstation/base/random.h"

namespace bess {

class UnitAutoregression {
 public:
  /// `correlation` between neighbours, -1 .. 1.
  explicit UnitAutoregression(double correlation) : correlation_(correlation) {}
  double next(Random& random);

 private:
  double correlation_;
  double value_ = 0;
  bool started_ = false;
};

}  // namespace bess
