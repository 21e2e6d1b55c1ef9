#include "edge/program/signature_command.h"

#include <cinttypes>
#include <cstdio>

#include "edge/control/decision_signature.h"
#include "edge/control/policy.h"
#include "shared/local_time.h"

namespace bess {

int run_signature_command() {
  set_market_time_zone();
  const DecisionSignature found = replay_recorded_days();
  std::printf("student=%08" PRIx32 " decisions=%d charging=%d discharging=%d signature=%016" PRIx64
              "\n",
              student_hash(), found.decisions, found.charging, found.discharging, found.signature);
  return 0;
}

}  // namespace bess
