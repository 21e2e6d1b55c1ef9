// Reports of runs: an HTML page with a plot of each run as inline SVG, and JUnit XML.
#pragma once

#include <string>
#include <vector>

#include "tools/hil_runner/run/outcome.h"

namespace bess {

// Outcomes as JUnit XML, for continuous integration.

std::string junit_text(const std::vector<Outcome>& outcomes);

// Plot of one run: price, orders and measured power, SoC, modes of the edge; faults as named bands.
// Axes are UTC.

/// SVG element. `span`: minutes of the scenario. Throws UserError without gnuplot.
std::string run_picture(const Outcome& outcome, const MinuteSpan& span);

/// Self-contained page without scripts. Throws UserError without gnuplot.
std::string report_page(const std::vector<Outcome>& outcomes);

}  // namespace bess
