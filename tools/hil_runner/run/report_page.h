// The reports of runs: one HTML page with a picture of each run as inline SVG, and JUnit XML.
#pragma once

#include <string>
#include <vector>

#include "tools/hil_runner/run/outcome.h"

namespace bess {

// Outcomes as JUnit's XML, which every continuous integration reads.

std::string junit_text(const std::vector<Outcome>& outcomes);

// One run as a picture: price, orders and measured power, SoC, the edge's modes; faults as named
// bands. Axes are UTC.

/// An SVG element. `span`: of the scenario's minutes. Throws UserError without gnuplot.
std::string run_picture(const Outcome& outcome, const MinuteSpan& span);

/// A page without scripts and without anything from elsewhere. Throws UserError without gnuplot.
std::string report_page(const std::vector<Outcome>& outcomes);

}  // namespace bess
