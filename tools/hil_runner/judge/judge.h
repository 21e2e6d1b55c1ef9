// Judge: rules that hold in every scenario, checked on the battery trace and compared with the
// decision log. A scenario can exclude rules by name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/app/settings/edge_config.h"
#include "tools/hil_runner/evidence/evidence.h"
#include "tools/hil_runner/scenario/publication.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

/// Violation of a rule.
struct Finding {
  std::string rule;
  std::int64_t utc_s = 0;
  std::string expected;
  std::string seen;
};

struct JudgedRun {
  const Scenario& scenario;
  const MinuteSeries& prices;
  const EdgeConfig& config;
  const Evidence& evidence;
};

/// First finding of each violated rule and expectation, ascending in time.
std::vector<Finding> judge(const JudgedRun& judged_run);

}  // namespace bess
