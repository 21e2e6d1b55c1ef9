// CHECK: detection of programming errors, in every build. The handler is replaceable: bess-edge
// drives the battery to its safe state before the process ends, so that a bug costs a restart and
// leaves no order behind.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <utility>

namespace bess {

using CheckHandler = void (*)(const char* expression, const char* file, int line);

/// The function called before the process ends; null = none.
inline CheckHandler& check_handler() {
  static CheckHandler handler = nullptr;
  return handler;
}

[[noreturn]] inline void check_failed(const char* expression, const char* file, int line) {
  // write(2) instead of stdio: must neither allocate nor depend on a healthy heap.
  const auto put = [](const char* text) {
    const ssize_t ignored = write(STDERR_FILENO, text, std::strlen(text));
    static_cast<void>(ignored);
  };
  put("CHECK failed: ");
  put(expression);
  put(" in ");
  put(file);
  put("\n");
  // Called once: the handler runs the code that has just failed, and may fail again.
  const CheckHandler handler = std::exchange(check_handler(), nullptr);
  if (handler != nullptr) handler(expression, file, line);
  std::_Exit(70);
}

}  // namespace bess

#define BESS_CHECK(expression) \
  ((expression) ? static_cast<void>(0) : ::bess::check_failed(#expression, __FILE__, __LINE__))
