#include "workstation/base/student_t.h"

#include <cmath>
#include <numbers>

namespace bess {
namespace {

/// P(|T| < t). Abramowitz and Stegun 1964, 26.7.3 (odd degrees) and 26.7.4 (even), with
/// theta = atan(t / sqrt(degrees)).
double probability_within(double t, int degrees) {
  const double theta = std::atan(t / std::sqrt(static_cast<double>(degrees)));
  const double cosine = std::cos(theta);
  const bool is_odd = degrees % 2 == 1;
  double term = is_odd ? cosine : 1;
  double sum = degrees == 1 ? 0 : term;
  for (int k = is_odd ? 3 : 2; k < degrees; k += 2) {
    term *= cosine * cosine * (k - 1) / k;
    sum += term;
  }
  const double part = std::sin(theta) * sum;
  return is_odd ? 2 / std::numbers::pi * (theta + part) : part;
}

}  // namespace

double student_t_within(double coverage, int degrees) {
  constexpr double kTolerance = 1e-10;
  double low = 0;
  double high = 1;
  while (probability_within(high, degrees) < coverage) high *= 2;
  while (high - low > kTolerance * high) {
    const double middle = (low + high) / 2;
    double& bound = probability_within(middle, degrees) < coverage ? low : high;
    bound = middle;
  }
  return high;
}

}  // namespace bess
