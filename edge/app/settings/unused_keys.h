// Keys of a configuration without effect, with the reason.
#pragma once

#include <string>
#include <vector>

#include "edge/app/settings/edge_config.h"

namespace bess {

/// "[price] timeout_ms: retired, ...".
std::string retired_key_text(const RetiredKey& old);

/// "ramp_w_max: no step is larger than 8000 W".
std::vector<std::string> keys_without_effect(const EdgeConfig& config);

}  // namespace bess
