// Tests with many drawn cases take a few of them every day, and all if BESS_THOROUGH is set, as
// tools/test --full does.
#pragma once

#include <cstdlib>

namespace bess {

/// `few` every day, `all` in a thorough run.
inline int few_or_all(int few, int all) {
  return std::getenv("BESS_THOROUGH") != nullptr ? all : few;
}

}  // namespace bess
