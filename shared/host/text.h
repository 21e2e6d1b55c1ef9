// Text utilities: lines, text for messages and HTML, errno messages, nearest known word.
#pragma once

#include <cerrno>
#include <charconv>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace bess {

// Message for an errno of a file: plain text for frequent errors, else that of the system.

inline std::string errno_text(int error) {
  if (error == ELOOP) return "symbolic link loop; use the file itself";
  if (error == ENAMETOOLONG) return "the file name is too long; check it";
  return std::strerror(error);
}

// "Did you mean": nearest known word.

/// Word that begins with `given` or differs in at most a third of its letters; the first of equally
/// near ones. Empty: none.
std::string nearest_word(std::string_view given, const std::vector<std::string>& known);

/// "; did you mean WORD?", or nothing.
std::string did_you_mean(std::string_view given, const std::vector<std::string>& known);

// Text for HTML.

/// & < > " ' become entities.
std::string html_escaped(std::string_view text);

/// Replaces the hyphen of a number by a minus sign: at the start, after a space or a bracket.
std::string with_true_minus(std::string_view text);

/// Removes U+FEFF, which spreadsheets and editors of Windows write at the start.
inline std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return text;
}

/// Removes and returns the first line of `rest`, without line end (LF or CRLF).
inline std::string_view take_line(std::string_view& rest) {
  const std::size_t end = rest.find('\n');
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

/// The whole text as one number; false: it is something else, or out of range.
template <typename Number>
bool read_number(std::string_view text, Number& number) {
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  return read.ec == std::errc{} && read.ptr == end;
}

/// Replaces every `what` in `text`.
void replace_all(std::string& text, std::string_view what, std::string_view by);

/// Lines of `text`, each with "# " in front.
std::string comment_lines(std::string_view text);

/// Control characters of ASCII and C1 (as UTF-8).
bool holds_control(std::string_view text);

/// At most `size_max` bytes of `text` on one line: replaces control characters by spaces, and
/// merges spaces.
std::string one_line(std::string_view text, std::size_t size_max = std::string_view::npos);

/// True for texts that differ at most in the case of ASCII letters.
bool equals_ignoring_case(std::string_view a, std::string_view b);

/// printf to a string.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);
[[gnu::format(printf, 2, 3)]] void add_formatted(std::string& text, const char* format, ...);

/// "1 minute", "2 minutes".
std::string counted(std::size_t count, std::string_view noun);

}  // namespace bess
