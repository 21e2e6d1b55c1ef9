#include "edge/records/log/journal.h"

#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace bess {
namespace {

/// JOURNAL_STREAM names device and inode of the journal's socket; redirected output gets no prefix.
bool leads_to_journal(int fd) {
  const char* const stream = std::getenv("JOURNAL_STREAM");
  struct stat info {};
  if (stream == nullptr || fstat(fd, &info) != 0) return false;
  char ours[64];
  std::snprintf(ours, sizeof ours, "%llu:%llu", static_cast<unsigned long long>(info.st_dev),
                static_cast<unsigned long long>(info.st_ino));
  return std::strcmp(stream, ours) == 0;
}

void write_pieces(int fd, JournalLevel level, std::string_view lead, std::string_view text) {
  const char* const prefix = journal_prefix(fd, level);
  char end[] = "\n";
  iovec pieces[] = {{const_cast<char*>(prefix), std::strlen(prefix)},
                    {const_cast<char*>(lead.data()), lead.size()},
                    {const_cast<char*>(text.data()), text.size()},
                    {end, 1}};
  const ssize_t ignored = writev(fd, pieces, 4);
  static_cast<void>(ignored);
}

}  // namespace

const char* journal_prefix(int fd, JournalLevel level) {
  constexpr const char* kPrefixes[] = {"<3>", "<4>", "<5>", "<6>"};
  if (!leads_to_journal(fd)) return "";
  return kPrefixes[static_cast<int>(level) - static_cast<int>(JournalLevel::kError)];
}

void write_journal_line(JournalLevel level, std::string_view text) {
  write_pieces(STDOUT_FILENO, level, "", text);
}

void report(JournalLevel level, const char* format, ...) {
  char line[1024];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  write_pieces(STDERR_FILENO, level, "bess-edge: ", line);
}

}  // namespace bess
