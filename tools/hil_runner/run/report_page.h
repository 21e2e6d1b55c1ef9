// Reports of runs: JUnit XML, and an HTML page with a chart for each run.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/hil_runner/run/run_scenario.h"

namespace bess {

// Outcomes as JUnit XML, for continuous integration.

std::string junit_text(const std::vector<Outcome>& outcomes);

// One self-contained page. Charts by UTC: price, power ordered and measured, SoC, mode of the edge;
// faults and events by name.

/// Embedded file of the page: style sheet or script.
std::string_view page_file(std::string_view name);

std::string report_page(const std::vector<Outcome>& outcomes);

}  // namespace bess
