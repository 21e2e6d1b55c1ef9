// What a configuration says that its defaults do not.
#pragma once

#include <string>
#include <vector>

#include "workstation/chain/run_config.h"

namespace bess {

struct ChangedKey {
  std::string key;  ///< "[section] name"
  std::string value;
  std::string standard;
};

/// In the order of the list of keys; seed, threads and rules are no keys.
std::vector<ChangedKey> changed_keys(const RunConfig& config);

/// "[market] observation_delay_min = 2 (default 1); ...", or that there are none.
std::string changed_keys_text(const RunConfig& config);

}  // namespace bess
