#include "edge/commands/signature_command.h"

#include <cinttypes>
#include <cstdio>

#include "edge/control/decision_signature.h"
#include "edge/control/policy.h"
#include "shared/local_time.h"

namespace bess {

std::string decision_signature_line() {
  set_market_time_zone();
  const DecisionSignature found = replay_recorded_days();
  char line[128];
  std::snprintf(
      line, sizeof line,
      "student=%08" PRIx32 " decisions=%d charging=%d discharging=%d signature=%016" PRIx64,
      student_hash(), found.decisions, found.charging, found.discharging, found.signature);
  return line;
}

int run_signature_command() {
  std::puts(decision_signature_line().c_str());
  return 0;
}

}  // namespace bess
