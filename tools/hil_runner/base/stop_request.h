// Ctrl-C, SIGTERM and a hang-up while scenarios run: whoever waits looks at the flag, ends what it
// started and throws Interrupted. A second one ends the program at once, with exit code 130.
#pragma once

#include <termios.h>

namespace bess {

/// Before any thread is started: all of them leave these signals to one that waits for nothing
/// else.
void watch_for_stop();
/// As a signal does: for a key.
void request_stop();

/// Throws Interrupted once a stop was requested.
void throw_if_stopped();

/// Q at the terminal, whatever the program's own streams are. Without a terminal there are the
/// signals alone.
class AbortKey {
 public:
  AbortKey();
  AbortKey(const AbortKey&) = delete;
  AbortKey& operator=(const AbortKey&) = delete;
  ~AbortKey();
  [[nodiscard]] bool is_pressed() const;

 private:
  int terminal_;  ///< -1: there is none
  termios before_{};
};

}  // namespace bess
