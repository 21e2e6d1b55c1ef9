// What must hold in every scenario, judged by the battery's own record: the edge's log is only held
// against it. A scenario may leave some out, by name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/app/settings/edge_config.h"
#include "tools/hil_runner/evidence/evidence.h"
#include "tools/hil_runner/scenario/publication.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

/// What did not hold: expected, seen, and when.
struct Finding {
  std::string rule;
  std::int64_t utc_s = 0;
  std::string expected;
  std::string seen;
};

struct Trial {
  const Scenario& scenario;
  const MinuteSeries& prices;
  const EdgeConfig& config;
  const Evidence& evidence;
};

/// The first finding of each broken invariant and expectation, in the order of time.
std::vector<Finding> judge(const Trial& trial);

}  // namespace bess
