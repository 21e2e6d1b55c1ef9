#include "workstation/io/random.h"

#include <cmath>

namespace bess {

double Random::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  double u = 0;
  double v = 0;
  double radius = 0;
  do {
    u = 2 * uniform() - 1;
    v = 2 * uniform() - 1;
    radius = u * u + v * v;
  } while (radius >= 1 || radius == 0);
  const double scale = std::sqrt(-2 * std::log(radius) / radius);
  spare_ = v * scale;
  has_spare_ = true;
  return u * scale;
}

}  // namespace bess
