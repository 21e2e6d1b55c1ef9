// The programs that the tests of processes start: those of this build, or those of another one,
// whose compiler or sanitizer looks at the programs alone (BESS_EDGE_UNDER_TEST,
// BESS_SIM_UNDER_TEST: paths).
#pragma once

#include <cstdlib>
#include <string>

namespace bess {

inline std::string edge_program() {
  return BESS_EDGE_PROGRAM;  // which itself looks at BESS_EDGE_UNDER_TEST
}
inline std::string sim_program() {
  const char* other = std::getenv("BESS_SIM_UNDER_TEST");
  return other != nullptr ? other : BESS_SIM_PROGRAM;
}

}  // namespace bess
