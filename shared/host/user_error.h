// Errors that the user can correct: bad file, bad key, bad value. Thrown when reading files, caught
// in main, printed as one line with place and remedy; exit code 1.
#pragma once

#include <fmt/core.h>

#include <stdexcept>
#include <string>

namespace bess {

class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <typename... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
  throw UserError(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace bess
