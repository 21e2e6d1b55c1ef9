// Stop request: Ctrl-C, SIGTERM and hang-up while scenarios run. Waiting code checks the flag, ends
// what it started and throws Interrupted. A second one ends the program immediately, exit code 130.
#pragma once

#include <termios.h>

namespace bess {

/// Call before any thread starts: one thread receives these signals, all others block them.
void watch_for_stop();
/// Same as a signal, for a key.
void request_stop();

/// Throws Interrupted once a stop was requested.
void throw_if_stopped();

/// Key Q at the terminal, independent of the program's streams. Without a terminal: signals only.
class AbortKey {
 public:
  AbortKey();
  AbortKey(const AbortKey&) = delete;
  AbortKey& operator=(const AbortKey&) = delete;
  ~AbortKey();
  [[nodiscard]] bool is_pressed() const;

 private:
  int terminal_;  ///< -1: none
  termios before_{};
};

}  // namespace bess
