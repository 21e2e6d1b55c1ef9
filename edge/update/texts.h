// Texts of the supervisor: pieces put together, and small files read whole.
#pragma once

#include <fstream>
#include <initializer_list>
#include <iterator>
#include <string>
#include <string_view>

namespace bess {

inline std::string joined(std::initializer_list<std::string_view> parts) {
  std::string text;
  for (const std::string_view part : parts) text.append(part);
  return text;
}

/// Always false, with the reason in `error`.
inline bool refuse(std::string& error, std::initializer_list<std::string_view> parts) {
  error = joined(parts);
  return false;
}

/// Empty where there is no such file.
inline std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace bess
