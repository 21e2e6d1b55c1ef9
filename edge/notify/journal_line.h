// "bess-notify: ..." on stdout, with its level under systemd.
#pragma once

#include <string>

#include "edge/log/journal.h"

namespace bess {

inline void say(JournalLevel level, const std::string& text) {
  write_journal_line(level, "bess-notify: " + text);
}

}  // namespace bess
