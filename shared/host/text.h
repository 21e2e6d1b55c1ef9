// Text: lines, text made fit for a message or for HTML, an errno in words, the nearest known word.
#pragma once

#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

// What an errno says of a file, for people: the common slips in plain words, the rest in the
// system's.

inline std::string errno_text(int error) {
  if (error == ELOOP) return "it is a link that leads back to itself; name the file itself";
  if (error == ENAMETOOLONG) return "the name is too long for a file; check it";
  return std::strerror(error);
}

// "Did you mean": of the words that would have been understood, the one that was probably meant.

/// Empty when none of `known` is near: more than a third of the letters would have to change, or it
/// does not begin with `given`. Of several equally near the first one is taken.
std::string nearest_word(std::string_view given, const std::vector<std::string>& known);

/// "; did you mean WORD?", or nothing.
std::string did_you_mean(std::string_view given, const std::vector<std::string>& known);

// Text into HTML.

/// & < > " ' become entities.
std::string html_escaped(std::string_view text);

/// A number's hyphen becomes a minus sign: at the start, behind a space or a bracket.
std::string with_true_minus(std::string_view text);

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
