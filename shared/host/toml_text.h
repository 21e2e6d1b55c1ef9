// TOML wants ASCII outside quotes and comments. toml++ 3.3 does not check: one accented letter
// there is undefined behaviour (is_non_ascii_horizontal_whitespace reaches an "unreachable" point).
// Both sides look before they parse.
#pragma once

#include <algorithm>
#include <string_view>

namespace bess {

inline constexpr std::string_view kBareNonAsciiMessage =
    "not valid TOML: a character other than ASCII outside quotes and comments";

/// Where in a line a scanner of TOML is: a quote opens a string only where a key or a value begins.
/// In 30''' or 5["" it is part of a mistake in a number, which toml++ reads on and on.
class TomlPlace {
 public:
  [[nodiscard]] constexpr bool begins_word() const { return !in_word_; }
  constexpr void pass(char c) {
    if (c == '\n' || c == ',') {
      in_word_ = in_value_ = false;
    } else if (c == ' ' || c == '\t' || c == '\r' || c == ']' || c == '}') {
      in_word_ = false;
    } else if (c == '[' || c == '{') {
      if (!in_word_) in_value_ = false;
    } else {
      in_word_ = c != '=' || in_value_;
      in_value_ = in_value_ || c == '=';
    }
  }

 private:
  bool in_word_ = false;
  bool in_value_ = false;  ///< behind the = of a key
};

/// Line, counted from 1, of the first character other than ASCII outside quotes and comments; 0
/// when there is none.
constexpr int line_of_bare_non_ascii(std::string_view toml) {
  int line = 1;
  if (toml.starts_with("\xEF\xBB\xBF")) toml.remove_prefix(3);  // a byte order mark is allowed
  TomlPlace place;
  const auto skip = [&](std::size_t bytes) {
    if (bytes > 0) place.pass(toml[std::min(bytes, toml.size()) - 1]);
    line += static_cast<int>(std::ranges::count(toml.substr(0, bytes), '\n'));
    toml.remove_prefix(std::min(bytes, toml.size()));
  };
  while (!toml.empty()) {
    const char c = toml.front();
    if (static_cast<unsigned char>(c) >= 0x80) return line;
    if (c == '#') {
      skip(std::min(toml.find('\n'), toml.size()));
    } else if ((c == '"' || c == '\'') && place.begins_word()) {
      const std::string_view triple = c == '"' ? "\"\"\"" : "'''";
      const std::string_view quote = toml.starts_with(triple) ? triple : triple.substr(0, 1);
      skip(quote.size());
      while (!toml.empty() && !toml.starts_with(quote)) {
        if (quote.size() == 1 && toml.front() == '\n') break;  // unclosed: the parser's business
        skip(c == '"' && toml.front() == '\\' ? 2 : 1);
      }
      if (toml.starts_with(quote)) skip(quote.size());
    } else {
      skip(1);
    }
  }
  return 0;
}

}  // namespace bess
