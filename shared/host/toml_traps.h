// Detection of input that toml++ (3.3 and 3.4) cannot parse safely:
// - a non-ASCII character outside quotes and comments, after a backslash, or after a line
//   continuation in a string: undefined behaviour in its test for white space;
// - a key of many parts: nested tables, of which ten thousand overflow the stack;
// - too many values: each takes about 200 bytes, and the edge has 8 MiB in total.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

namespace bess {

/// Invalid place of a text, which may crash the parser.
struct TomlTrap {
  int line = 0;  ///< counted from 1; 0: none
  std::string_view message{};
};

class TomlTrapFinder {
 public:
  explicit TomlTrapFinder(std::string_view toml) : size_(toml.size()), rest_(toml) {}

  TomlTrap find() {
    while (!rest_.empty()) {
      const char c = rest_.front();
      if (!is_ascii(c)) {
        return {line_, "a non-ASCII character outside quotes and comments"};
      }
      if (c == '\r' && !rest_.substr(1).starts_with('\n')) {
        return {line_, "a line that ends with CR only: save it with LF or CR LF"};
      }
      if (c == '#') {
        skip(std::min(rest_.find('\n'), rest_.size()));
      } else if ((c == '"' || c == '\'') && !in_word_) {
        skip_string(c);
      } else {
        pass(c);
        skip(1);
      }
      if (escapes_letter_) return {line_, "a backslash before a non-ASCII character"};
      if (dots_ >= kKeyPartsMax) return {line_, "a key with too many parts"};
      if (pieces_ > kPiecesMax) return {line_, "too many lines and values"};
    }
    return {};
  }

  /// Offsets of non-ASCII characters at the start of continued lines of strings.
  [[nodiscard]] const std::vector<std::size_t>& continued_letters() const {
    return continued_letters_;
  }

 private:
  static constexpr int kKeyPartsMax = 16;
  static constexpr int kPiecesMax = 10'000;  ///< the largest shipped map has 545

  static bool is_ascii(char c) { return static_cast<unsigned char>(c) < 0x80; }

  void skip(std::size_t bytes) {
    bytes = std::min(bytes, rest_.size());
    line_ += static_cast<int>(std::ranges::count(rest_.substr(0, bytes), '\n'));
    rest_.remove_prefix(bytes);
  }

  /// Skips a backslash in a string with its escaped character, or the white space of a continued
  /// line.
  void skip_escape(bool is_multi_line) {
    skip(1);
    if (rest_.empty()) return;
    escapes_letter_ = escapes_letter_ || !is_ascii(rest_.front());
    if (!is_multi_line || std::string_view(" \t\r\n").find(rest_.front()) == rest_.npos) {
      return skip(1);
    }
    skip(std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size()));
    if (!rest_.empty() && !is_ascii(rest_.front())) {
      continued_letters_.push_back(size_ - rest_.size());
    }
  }

  /// Skips to after the closing quote. An unclosed one-line string ends at the line end; the parser
  /// reports it.
  void skip_string(char quote_mark) {
    const std::string_view triple = quote_mark == '"' ? "\"\"\"" : "'''";
    const std::string_view quote = rest_.starts_with(triple) ? triple : triple.substr(0, 1);
    skip(quote.size());
    in_word_ = true;
    while (!rest_.empty() && !rest_.starts_with(quote)) {
      if (quote.size() == 1 && rest_.front() == '\n') return;
      if (quote_mark == '"' && rest_.front() == '\\') {
        skip_escape(quote.size() > 1);
      } else {
        skip(1);
      }
    }
    skip(quote.size());
  }

  /// A quote opens a string only at the begin of a key or value: in 30''' or 5["" it is part of an
  /// invalid number.
  void pass(char c) {
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
    const bool is_dot_of_key = c == '.' && !in_value_;  // nested table
    const bool begins_piece = c == '\n' || c == ',' || c == '=' || c == '[' || c == '{';
    if (is_dot_of_key) ++dots_;
    if (begins_piece) dots_ = 0;
    if (is_dot_of_key || begins_piece) ++pieces_;
  }

  std::size_t size_;
  std::string_view rest_;
  std::vector<std::size_t> continued_letters_;
  int line_ = 1;
  int dots_ = 0;    ///< in the key so far
  int pieces_ = 0;  ///< lines, parts of keys and values so far
  bool escapes_letter_ = false;
  bool in_word_ = false;
  bool in_value_ = false;  ///< after the = of a key
};

}  // namespace bess
