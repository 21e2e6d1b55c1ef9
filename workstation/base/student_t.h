// Student's t: half-width of an interval whose standard error is estimated from few samples.
#pragma once

namespace bess {

/// The t with P(|T| < t) = `coverage` (0 < coverage < 1) for `degrees` of freedom (>= 1): 12.706
/// for 95 % and 1, 1.960 for 95 % and many. Accurate to 1e-9.
double student_t_within(double coverage, int degrees);

}  // namespace bess
