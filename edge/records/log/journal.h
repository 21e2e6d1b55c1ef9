// Lines for the journal: under systemd each starts with its level as "<N>" (sd-daemon(3)), in a
// terminal or a file it does not. Written with write(2), one call a line: no stdio stream, no heap.
#pragma once

#include <string_view>

namespace bess {

enum class JournalLevel { kError = 3, kWarning = 4, kNotice = 5, kInfo = 6 };

/// "<6>" or such when the descriptor leads to the journal, else "".
const char* journal_prefix(int fd, JournalLevel level);

/// One line on stdout. A full disk or a closed pipe loses the line and nothing else.
void write_journal_line(JournalLevel level, std::string_view text);

/// "bess-edge: ..." on stderr: why the start failed, or what a person should know.
[[gnu::format(printf, 2, 3)]] void report(JournalLevel level, const char* format, ...);

}  // namespace bess
