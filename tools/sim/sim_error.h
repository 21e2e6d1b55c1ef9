// Errors that the user can mend; caught in main, printed as one line, exit code 1.
#pragma once

#include <fmt/core.h>

#include <stdexcept>

namespace bess {

class SimError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <typename... Args>
[[noreturn]] void sim_fail(fmt::format_string<Args...> format, Args&&... args) {
  throw SimError(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace bess
