// The report of a run as one HTML page, pictures inside.
#pragma once

#include <string>
#include <vector>

#include "tools/hil_runner/run/outcome.h"

namespace bess {

/// A page without scripts and without anything from elsewhere. Throws UserError without gnuplot.
std::string report_page(const std::vector<Outcome>& outcomes);

}  // namespace bess
