// Paths of the programs that process tests start: those of this build, or of another one with its
// own compiler or sanitizer (BESS_EDGE_UNDER_TEST, BESS_SIM_UNDER_TEST).
#pragma once

#include <cstdlib>
#include <string>

namespace bess {

inline std::string edge_program() {
  return BESS_EDGE_PROGRAM;  // which itself reads BESS_EDGE_UNDER_TEST
}
inline std::string sim_program() {
  const char* other = std::getenv("BESS_SIM_UNDER_TEST");
  return other != nullptr ? other : BESS_SIM_PROGRAM;
}

}  // namespace bess
