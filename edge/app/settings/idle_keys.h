// Keys of a configuration that are set and do nothing, with the reason: what an operator believes
// to be in force and is not.
#pragma once

#include <string>
#include <vector>

#include "edge/app/settings/edge_config.h"

namespace bess {

/// "[price] timeout_ms: no longer a setting, ...".
std::string retired_key_text(const RetiredKey& old);

/// "guard.ramp_w_max: no change of order is larger than 8000 W".
std::vector<std::string> keys_without_effect(const EdgeConfig& config);

}  // namespace bess
