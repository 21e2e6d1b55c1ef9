// Lines out of a text, and text that is made fit for a message.
#pragma once

#include <string>
#include <string_view>

namespace bess {

/// Spreadsheets and editors of Windows begin a text with U+FEFF; no reader needs it.
inline std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return text;
}

/// Takes the first line off `rest`, without its line end (LF or CRLF).
inline std::string_view take_line(std::string_view& rest) {
  const std::size_t end = rest.find('\n');
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

/// The lines of `text`, each behind "# ".
std::string comment_lines(std::string_view text);

/// At most `size_max` bytes of `text` in one line: control characters, which a terminal would obey,
/// become spaces, and neighbouring spaces one.
std::string one_line(std::string_view text, std::size_t size_max = std::string_view::npos);

/// As printf writes it.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);
[[gnu::format(printf, 2, 3)]] void add_formatted(std::string& text, const char* format, ...);

/// "1 minute", "2 minutes".
std::string counted(std::size_t count, std::string_view noun);

}  // namespace bess
