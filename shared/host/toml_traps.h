// What toml++ 3.3 must not be shown, looked for before it parses. TOML wants ASCII outside quotes
// and comments, and toml++ does not check: one accented letter there is undefined behaviour. Nor
// does it limit the parts of a key: each becomes a table in a table, and some ten thousand of them
// overflow the stack. Nor the number of values: each takes some 200 bytes, and the edge has 8 MiB
// for everything.
#pragma once

#include <algorithm>
#include <string_view>

namespace bess {

/// Where a text is no TOML, or none that is worth a crash.
struct TomlTrap {
  int line = 0;  ///< counted from 1; 0 when there is none
  std::string_view message{};
};

class TomlTrapFinder {
 public:
  explicit constexpr TomlTrapFinder(std::string_view toml) : rest_(toml) {}

  constexpr TomlTrap find() {
    while (!rest_.empty()) {
      const char c = rest_.front();
      if (static_cast<unsigned char>(c) >= 0x80) {
        return {line_, "a character other than ASCII outside quotes and comments"};
      }
      if (c == '\r' && !rest_.substr(1).starts_with('\n')) {
        return {line_, "a line that ends in CR alone: save it with LF or CR LF"};
      }
      if (c == '#') {
        skip(std::min(rest_.find('\n'), rest_.size()));
      } else if ((c == '"' || c == '\'') && !in_word_) {
        skip_string(c);
      } else {
        pass(c);
        skip(1);
      }
      if (dots_ >= kKeyPartsMax) return {line_, "a key of more parts than any here"};
      if (pieces_ > kPiecesMax) return {line_, "more lines and values than any file here has"};
    }
    return {};
  }

 private:
  static constexpr int kKeyPartsMax = 16;
  static constexpr int kPiecesMax = 10'000;  ///< the largest shipped map has 545

  constexpr void skip(std::size_t bytes) {
    bytes = std::min(bytes, rest_.size());
    line_ += static_cast<int>(std::ranges::count(rest_.substr(0, bytes), '\n'));
    rest_.remove_prefix(bytes);
  }

  /// To behind the closing quote. A string of one line that is not closed ends there: the parser's
  /// business.
  constexpr void skip_string(char quote_mark) {
    const std::string_view triple = quote_mark == '"' ? "\"\"\"" : "'''";
    const std::string_view quote = rest_.starts_with(triple) ? triple : triple.substr(0, 1);
    skip(quote.size());
    in_word_ = true;
    while (!rest_.empty() && !rest_.starts_with(quote)) {
      if (quote.size() == 1 && rest_.front() == '\n') return;
      skip(quote_mark == '"' && rest_.front() == '\\' ? 2 : 1);
    }
    skip(quote.size());
  }

  /// A quote opens a string only where a key or a value begins: in 30''' or 5["" it is part of a
  /// mistake in a number, which toml++ reads on and on.
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
    const bool is_dot_of_key = c == '.' && !in_value_;  // a table in a table
    const bool begins_piece = c == '\n' || c == ',' || c == '=' || c == '[' || c == '{';
    if (is_dot_of_key) ++dots_;
    if (begins_piece) dots_ = 0;
    if (is_dot_of_key || begins_piece) ++pieces_;
  }

  std::string_view rest_;
  int line_ = 1;
  int dots_ = 0;    ///< in the key so far
  int pieces_ = 0;  ///< lines, parts of keys and values so far
  bool in_word_ = false;
  bool in_value_ = false;  ///< behind the = of a key
};

constexpr TomlTrap find_toml_trap(std::string_view toml) { return TomlTrapFinder(toml).find(); }

}  // namespace bess
