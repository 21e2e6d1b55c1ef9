// Tests that draw, kill or live through many cases take a few of them every day, and all where
// BESS_THOROUGH is set, which tools/test --full does.
#pragma once

#include <cstdlib>

namespace bess {

/// `few` every day, `all` in a thorough run.
inline int few_or_all(int few, int all) {
  return std::getenv("BESS_THOROUGH") != nullptr ? all : few;
}

}  // namespace bess
