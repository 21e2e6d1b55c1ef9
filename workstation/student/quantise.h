// From the float student to the integer one: the largest power-of-two scale for each layer at which
// no weight leaves int16, no accumulator can leave int32 and no activation saturates for ANY
// lattice input.
#pragma once

#include <limits>

#include "shared/nn/student_net.h"
#include "workstation/nn/mlp.h"
#include "workstation/rl/price_map.h"

namespace bess {

/// Throws UserError when the weights are so large that no scale fits.
/// `saturation`: where the float student's hidden activations were cut off, a power of two;
/// infinite for plain ReLU, whose integer activations never reach their end.
StudentNet quantise_student(const Parameters& student, const PriceMap& price_map,
                            double saturation = std::numeric_limits<double>::infinity());

/// Largest magnitude that any int32 sum of the net can reach over all inputs, rounding included.
std::int64_t accumulator_bound(const StudentNet& net);

}  // namespace bess
