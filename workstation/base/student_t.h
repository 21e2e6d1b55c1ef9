// Student's t: how wide an interval must be when the error itself is known from a few draws only.
#pragma once

namespace bess {

/// The t that |T| stays below with probability `coverage` (0 < coverage < 1), T with `degrees` of
/// freedom (1 or more): 12.706 for 95 % and 1, 1.960 for 95 % and many. To 1e-9.
double student_t_within(double coverage, int degrees);

}  // namespace bess
