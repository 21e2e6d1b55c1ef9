// Transport security of a price: who could read or change it in transit. Start-up only: used by the
// configuration, reported at start.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "shared/fixed_text.h"

namespace bess {

enum class UrlTransport : std::uint8_t {
  kUnusable,  ///< not an http or https URL with a host
  kSecure,    ///< https: authenticated host, encrypted
  kLoopback,  ///< plain http inside this machine
  kOpen       ///< plain http: prices can be forged in transit
};

/// Loopback is numeric 127.0.0.0/8 and [::1]: the name localhost depends on the resolver.
UrlTransport transport_of(std::string_view url);

/// "host:port" of a URL; empty without a host.
std::string place_of_url(std::string_view url);

/// True if the URL contains a user or a password, which are sent with every request.
bool holds_login(std::string_view url);

// Secrets of an HTTP request: the header file, and parts of URLs. They are never logged. Start-up
// only: read by edge_config, shown by startup.

/// Reads lines "Name: value" sent with every request; '#' starts a comment. False with one line
/// that never contains the secret.
bool load_http_headers(const char* path, FixedText<2047>& headers, std::string& error);

/// Positions of the parts of "scheme://login@host/path?query".
struct UrlParts {
  std::size_t authority_at = 0;  ///< after the scheme
  std::size_t login_bytes = 0;   ///< user and password including @; 0 = none
  std::size_t path_at = 0;       ///< after the host and its port
};
UrlParts url_parts(std::string_view url);

/// A URL for the log: without user and password, and with "..." for the value of every query name
/// not known to be harmless.
FixedText<511> loggable_url(std::string_view url);

}  // namespace bess
