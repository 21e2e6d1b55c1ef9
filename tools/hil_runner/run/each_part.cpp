#include "tools/hil_runner/run/each_part.h"

#include <fmt/core.h>

#include "tools/hil_runner/run/run_scenario.h"
#include "tools/hil_runner/scenario/scenario_parts.h"

namespace bess {
namespace {

/// One that cannot be run to its end differs, whatever was recorded until then.
bool is_same_run(const Outcome& one, const Outcome& other) {
  return other.error.empty() && one.signature == other.signature;
}

}  // namespace

std::vector<Finding> judge_parts(const Outcome& outcome) {
  const Scenario& scenario = outcome.scenario;
  std::vector<Finding> findings;
  const auto judge = [&](const std::string& part, bool is_same) {
    const auto excuse = scenario.same_without.find(part);
    if (is_same == (excuse != scenario.same_without.end())) return;
    findings.push_back(
        {.rule = "part " + part,
         .utc_s = scenario.start_utc_s,
         .expected = is_same ? "another run without it, or the reason in [same_without]"
                             : fmt::format("the same run without it, as \"{}\"", excuse->second),
         .seen = is_same ? "the same to the bit" : "another"});
  };
  const std::vector<ScenarioPart> parts = parts_of(scenario);
  if (parts.empty()) judge(std::string(kNothing), true);
  for (const ScenarioPart& part : parts) {
    judge(part.name, is_same_run(outcome, run_scenario(part.without, true, {})));
  }
  return findings;
}

}  // namespace bess
