// What is known of a price on its way here: who could have written it, who could have read what was
// sent. Start-up only: asked by the configuration, told at the start.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

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

}  // namespace bess
