// A URL as it may be shown: user, password and query may hold secrets, so they are left out.
#pragma once

#include <string_view>

#include "shared/fixed_text.h"

namespace bess {

/// "https://user:secret@host/path?apikey=secret" becomes "https://host/path".
constexpr FixedText<511> public_url(std::string_view url) {
  url = url.substr(0, url.find_first_of("?#"));
  const std::size_t scheme_end = url.find("://");
  if (scheme_end == std::string_view::npos) return {url};
  const std::string_view scheme = url.substr(0, scheme_end + 3);
  std::string_view rest = url.substr(scheme.size());
  const std::size_t at = rest.substr(0, rest.find('/')).rfind('@');
  if (at != std::string_view::npos) rest.remove_prefix(at + 1);
  char text[512] = {};
  std::size_t size = 0;
  for (const std::string_view part : {scheme, rest}) {
    for (const char c : part) {
      if (size < 511) text[size++] = c;
    }
  }
  return {std::string_view(text, size)};
}

}  // namespace bess
