// Cutting text into lines without copying.
#pragma once

#include <string_view>

namespace bess {

/// Takes the first line off `rest`, without its line end (LF or CRLF).
inline std::string_view take_line(std::string_view& rest) {
  const std::size_t end = rest.find('\n');
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

}  // namespace bess
