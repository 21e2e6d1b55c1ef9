// A student that is monotone by construction [SPEC 5, property 3]: which weights may have which
// sign, in the student's own 5-64-32-3. Monotone networks are Sill (1998) and Daniels and Velikova
// (2010); units that fall and units that rise side by side, and free ones for the inputs without an
// order, are what Runje and Shankaranarayana (2023) call a constrained monotone network.
//
//   hidden 1   20 units fall with price and SoC (weights <= 0), 20 rise (>= 0), 24 do not see them;
//              time and context enter all of them freely
//   hidden 2   16 falling units: weights >= 0 from falling, <= 0 from rising, free from the others;
//              16 rising units: the other way round
//   logits     idle is the origin; charge takes falling units >= 0 and rising ones <= 0, discharge
//              the other way round
//
// So neither charge - idle nor idle - discharge can rise with price or SoC, whatever the weights
// are inside these bounds. Rounding to integers keeps every sign, and the integer activations rise
// with their sums: the exported student has the property too.
#pragma once

#include <vector>

#include "workstation/nn/mlp.h"
#include "workstation/rules/rule.h"

namespace bess {

/// Bounds of every parameter of a student, in the layout of mlp.h.
class SignBounds {
 public:
  /// No bound at all.
  static SignBounds none();
  /// The bounds above, and the same for other inputs: where the action never falls with one,
  /// falling units rise with it. Free units see no input that has a direction.
  static SignBounds monotone(const std::vector<Direction>& directions = RuleSet{}.directions());

  /// Turns the sign of what lies outside: a start inside with as many weights that matter.
  void reflect(Parameters& parameters) const;
  /// To the nearest parameters inside.
  void clamp(Parameters& parameters) const {
    parameters = parameters.cwiseMax(lower_).cwiseMin(upper_);
  }
  [[nodiscard]] bool contain(const Parameters& parameters) const {
    return (parameters.array() >= lower_.array()).all() &&
           (parameters.array() <= upper_.array()).all();
  }

 private:
  Parameters lower_, upper_;
};

}  // namespace bess
