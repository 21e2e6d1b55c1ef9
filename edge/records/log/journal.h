// Journal lines: under systemd each starts with its level as "<N>" (sd-daemon(3)), in a terminal or
// file it does not. Written with one writev(2) per line: no stdio stream, no heap.
#pragma once

#include <string_view>

namespace bess {

enum class JournalLevel { kError = 3, kWarning = 4, kNotice = 5, kInfo = 6 };

/// Prefix such as "<6>" when the descriptor is the journal, else "".
const char* journal_prefix(int fd, JournalLevel level);

/// One line on stdout. A full disk or a closed pipe loses only the line.
void write_journal_line(JournalLevel level, std::string_view text);

/// "bess-edge: ..." on stderr: an error or a note for the operator.
[[gnu::format(printf, 2, 3)]] void report(JournalLevel level, const char* format, ...);

}  // namespace bess
