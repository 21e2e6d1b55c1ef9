#include "workstation/base/random.h"

#include <bit>
#include <cmath>
#include <sstream>

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

std::string Random::state() const {
  std::ostringstream text;
  text << engine_ << ' ' << std::bit_cast<std::uint64_t>(spare_) << ' ' << has_spare_;
  return text.str();
}

bool Random::restore(const std::string& state) {
  std::istringstream text(state);
  std::uint64_t spare = 0;
  text >> engine_ >> spare >> has_spare_;
  spare_ = std::bit_cast<double>(spare);
  return !text.fail();
}

}  // namespace bess
