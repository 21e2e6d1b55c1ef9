// "bess-page: ..." on stdout, with its level under systemd.
#pragma once

#include <string>

#include "edge/log/journal.h"

namespace bess {

inline void say_on_page(JournalLevel level, const std::string& text) {
  write_journal_line(level, "bess-page: " + text);
}

}  // namespace bess
