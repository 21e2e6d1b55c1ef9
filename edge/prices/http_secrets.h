// What of an HTTP request is secret: the header file, and parts of URLs. Nothing of it is ever
// logged. Start-up only: read by edge_config, shown by startup.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "shared/fixed_text.h"

namespace bess {

/// Reads lines "Name: value" that are sent with every request; '#' starts a comment. False with one
/// line that never holds the content.
bool load_http_headers(const char* path, FixedText<2047>& headers, std::string& error);

/// Where the pieces of "scheme://login@host/path?query" lie.
struct UrlParts {
  std::size_t authority_at = 0;  ///< behind the scheme
  std::size_t login_bytes = 0;   ///< user and password with their @; 0 = none
  std::size_t path_at = 0;       ///< behind the host and its port
};
UrlParts url_parts(std::string_view url);

/// A URL as it may be logged: without user and password, and with "..." for the value of every
/// query name that is not known to be harmless.
FixedText<511> loggable_url(std::string_view url);

}  // namespace bess
