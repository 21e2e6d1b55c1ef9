// What a message must name, whatever its words are: places, keys, values, codes, options, commands.
#pragma once

#include <gmock/gmock.h>

#include <cctype>
#include <string>
#include <string_view>

namespace bess {

/// Whether `token` stands in `text`, and not as a piece of a longer word or number.
inline bool is_named(std::string_view text, std::string_view token) {
  const auto touch = [](char left, char right) {
    const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
    return is_word(left) && is_word(right);
  };
  for (std::size_t at = text.find(token); at != text.npos; at = text.find(token, at + 1)) {
    const std::size_t end = at + token.size();
    if (token.empty()) return true;
    const bool begins = at == 0 || !touch(text[at - 1], token.front());
    if (begins && (end == text.size() || !touch(token.back(), text[end]))) return true;
  }
  return false;
}

MATCHER_P(NamesEachOf, list, "names each of: " + list) {
  const std::string_view all = list;
  for (std::size_t at = 0; at <= all.size();) {
    const std::size_t end = std::min(all.find(", ", at), all.size());
    const std::string_view token = all.substr(at, end - at);
    if (!is_named(arg, token)) {
      *result_listener << "which does not name " << token;
      return false;
    }
    at = end + 2;
  }
  return true;
}

/// Matches a text that names every token of every list; a list is "one, another, a third".
template <typename... Lists>
auto NamesAll(const Lists&... lists) {
  return testing::AllOf(NamesEachOf(std::string(lists))...);
}

}  // namespace bess
