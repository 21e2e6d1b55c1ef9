// What is known of a price on its way here: who could have written it, who could have read what was
// sent. Start-up only: asked by the configuration, told at the start.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "shared/fixed_text.h"

namespace bess {

enum class UrlTransport : std::uint8_t {
  kUnusable,  ///< no http or https URL with a host
  kSecure,    ///< https: written by the named host, read by nobody else
  kLoopback,  ///< plain http inside this machine
  kOpen       ///< plain http: whoever is on the way can write the prices
};

/// Loopback is 127.0.0.0/8 and [::1] as numbers: the name localhost is what the resolver says it
/// is.
UrlTransport transport_of(std::string_view url);

/// "host:port" of a URL; empty where it names no host.
std::string place_of_url(std::string_view url);

/// True when the URL holds a user or a password, which are sent with every request.
bool holds_login(std::string_view url);

// What of an HTTP request is secret: the header file, and parts of URLs. Nothing of it is ever
// logged. Start-up only: read by edge_config, shown by startup.

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
