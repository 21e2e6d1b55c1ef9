#include "workstation/correction/sign_bounds.h"

#include <limits>

#include "workstation/correction/distil.h"

namespace bess {
namespace {

enum class Trend { kFalls, kRises, kFree };

constexpr int kFalling1 = 20;
constexpr int kRising1 = 20;
constexpr int kFalling2 = kStudentHidden2 / 2;
constexpr float kUnbounded = std::numeric_limits<float>::max();

Trend trend1(int unit) {
  if (unit < kFalling1) return Trend::kFalls;
  return unit < kFalling1 + kRising1 ? Trend::kRises : Trend::kFree;
}
Trend trend2(int unit) { return unit < kFalling2 ? Trend::kFalls : Trend::kRises; }

}  // namespace

SignBounds SignBounds::none() {
  SignBounds bounds;
  bounds.lower_ = Parameters::Constant(kStudentShape.parameter_count(), -kUnbounded);
  bounds.upper_ = -bounds.lower_;
  return bounds;
}

SignBounds SignBounds::monotone(const std::vector<Direction>& directions) {
  SignBounds bounds = none();
  MutableMlp lower(kStudentShape, bounds.lower_.data());
  MutableMlp upper(kStudentShape, bounds.upper_.data());
  for (int unit = 0; unit < kStudentHidden1; ++unit) {
    for (const Direction& direction : directions) {
      const int input = static_cast<int>(direction.input);
      MutableMlp& of_falling = direction.sign < 0 ? upper : lower;
      MutableMlp& of_rising = direction.sign < 0 ? lower : upper;
      if (trend1(unit) != Trend::kRises) of_falling.w1(unit, input) = 0;
      if (trend1(unit) != Trend::kFalls) of_rising.w1(unit, input) = 0;
    }
    if (trend1(unit) == Trend::kFree) continue;
    for (int next = 0; next < kStudentHidden2; ++next) {
      (trend1(unit) == trend2(next) ? lower : upper).w2(next, unit) = 0;
    }
  }
  constexpr auto kDischarge = static_cast<int>(Action::kDischarge);
  constexpr auto kIdle = static_cast<int>(Action::kIdle);
  constexpr auto kCharge = static_cast<int>(Action::kCharge);
  for (int unit = 0; unit < kStudentHidden2; ++unit) {
    const bool falls = trend2(unit) == Trend::kFalls;
    lower.w3(kIdle, unit) = upper.w3(kIdle, unit) = 0;
    (falls ? lower : upper).w3(kCharge, unit) = 0;
    (falls ? upper : lower).w3(kDischarge, unit) = 0;
  }
  return bounds;
}

void SignBounds::reflect(Parameters& parameters) const {
  for (Eigen::Index i = 0; i < parameters.size(); ++i) {
    if (parameters[i] < lower_[i] || parameters[i] > upper_[i]) parameters[i] = -parameters[i];
  }
  clamp(parameters);
}

}  // namespace bess
