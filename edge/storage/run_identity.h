// Who a run is, for the status that it publishes: this build, this configuration, this process.
#pragma once

#include "edge/log/run_status.h"
#include "edge/settings/edge_config.h"

namespace bess {

RunIdentity identity_of_run(const EdgeConfig& config);

}  // namespace bess
