// Numeric addresses of hosts, as text.
#pragma once

#include <arpa/inet.h>

#include <string>

namespace bess {

/// IPv4 or IPv6, without a port.
inline bool is_numeric_address(const std::string& host) {
  in6_addr ignored{};
  return inet_pton(AF_INET, host.c_str(), &ignored) == 1 ||
         inet_pton(AF_INET6, host.c_str(), &ignored) == 1;
}

inline bool is_loopback_address(const std::string& host) {
  in_addr address{};
  if (inet_pton(AF_INET, host.c_str(), &address) == 1) return ntohl(address.s_addr) >> 24 == 127;
  return host == "::1";
}

}  // namespace bess
