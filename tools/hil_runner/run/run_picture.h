// One run as a picture: price, orders and measured power, SoC, the edge's modes; faults as named
// bands. Axes are UTC.
#pragma once

#include <string>

#include "tools/hil_runner/run/outcome.h"

namespace bess {

/// An SVG element. `span`: of the scenario's minutes. Throws UserError without gnuplot.
std::string run_picture(const Outcome& outcome, const MinuteSpan& span);

}  // namespace bess
