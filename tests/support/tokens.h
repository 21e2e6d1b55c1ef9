// Codes in a message: files, lines, keys, options, commands, values. A test checks these, and the
// wording around them is free.
#pragma once

#include <gmock/gmock.h>

#include <cctype>
#include <sstream>
#include <string>
#include <string_view>

namespace bess {

inline bool is_of_a_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

/// Whether `code` occurs in the text as a whole: power_w is not in power_w_max, nor x:3 in x:31.
inline bool has_code(std::string_view text, std::string_view code) {
  for (std::size_t at = text.find(code); at != text.npos; at = text.find(code, at + 1)) {
    const std::size_t end = at + code.size();
    const bool begins = at == 0 || !is_of_a_name(code.front()) || !is_of_a_name(text[at - 1]);
    const bool ends = end == text.size() || !is_of_a_name(code.back()) || !is_of_a_name(text[end]);
    if (begins && ends) return true;
  }
  return false;
}

inline std::size_t count_of(std::string_view text, std::string_view piece) {
  std::size_t count = 0;
  for (std::size_t at = text.find(piece); at != text.npos; at = text.find(piece, at + 1)) ++count;
  return count;
}

/// Whether each of these codes, split at spaces, occurs: Names("edge.toml:3 power_w 4000").
MATCHER_P(Names, codes, "names " + ::testing::PrintToString(std::string(codes))) {
  std::istringstream words{std::string(codes)};
  bool has_all = true;
  for (std::string word; words >> word;) {
    if (has_code(std::string_view(arg), word)) continue;
    *result_listener << "which does not name " << word << " ";
    has_all = false;
  }
  return has_all;
}

}  // namespace bess
