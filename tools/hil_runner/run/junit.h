// Outcomes as JUnit's XML, which every continuous integration reads.
#pragma once

#include <string>
#include <vector>

#include "tools/hil_runner/run/outcome.h"

namespace bess {

std::string junit_text(const std::vector<Outcome>& outcomes);

}  // namespace bess
