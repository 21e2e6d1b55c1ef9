// One linear demand on the student's logit differences at the states of a batch: what a property or
// an operator's rule becomes before the constraint layer (constraint_layer.h) projects onto it.
//
//   u = z_charge - z_idle     v = z_idle - z_discharge     (both in logits, one of each per state)
//
//   state 4 charges:             u_4 >= m             {"rule", {{4, kU, 1}}, m}
//                                v_4 >= 0             {"rule", {{4, kV, 1}}, 0}
//   state 4 does not discharge:  v_4 >= m             {"rule", {{4, kV, 1}}, m}
//   u falls from state 4 to 7:   u_4 - u_7 >= slope   {"rule", {{4, kU, 1}, {7, kU, -1}}, slope}
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace bess {

enum class Difference : std::uint8_t {
  kU,  ///< z_charge - z_idle
  kV,  ///< z_idle - z_discharge
};

struct DifferenceTerm {
  int state;  ///< column of the batch, 0..states-1
  Difference difference;
  double factor;
};

/// sum of factor * difference >= bound, or = bound.
struct DifferenceRow {
  std::string rule;  ///< whose row it is: every report names it
  std::vector<DifferenceTerm> terms;
  double bound = 0;
  bool is_equality = false;
};

}  // namespace bess
