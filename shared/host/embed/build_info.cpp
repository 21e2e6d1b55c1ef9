#include "shared/host/embed/build_info.h"

#include "shared/host/commit.h"  // written by ask_commit.cmake

namespace bess {

std::string_view build_commit() { return BESS_COMMIT; }

std::string_view build_compiler() {
#ifdef __clang__
  return "clang " __clang_version__;
#else
  return "g++ " __VERSION__;
#endif
}

}  // namespace bess
