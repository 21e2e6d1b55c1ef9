#include "edge/prices/http_trust.h"

#include <arpa/inet.h>

#include <algorithm>
#include <string>

#include "edge/prices/http_secrets.h"

namespace bess {
namespace {

struct Place {
  std::string host;  ///< without the brackets of IPv6
  std::string port;  ///< empty: the scheme's
};

/// False where the URL names no host, or a port that is no number.
bool find_place(std::string_view url, Place& place) {
  const UrlParts parts = url_parts(url);
  const std::size_t begin = parts.authority_at + parts.login_bytes;
  std::string_view text = url.substr(begin, parts.path_at - begin);
  const bool is_ipv6 = text.starts_with('[');
  const std::size_t host_end = is_ipv6 ? text.find(']') : text.find(':');
  place.host = text.substr(is_ipv6 ? 1 : 0, host_end - (is_ipv6 ? 1 : 0));
  text.remove_prefix(std::min(host_end, text.size()) + (is_ipv6 ? 1 : 0));
  if (!text.empty()) place.port = text.substr(1);
  constexpr std::string_view kNoHost = " \t\\<>\"^`{|}%";
  return !place.host.empty() && place.host.find_first_of(kNoHost) == place.host.npos &&
         place.port.find_first_not_of("0123456789") == place.port.npos;
}

/// 127.0.0.0/8 and [::1], as numbers.
bool is_loopback(const std::string& host) {
  in_addr v4{};
  in6_addr v6{};
  if (inet_aton(host.c_str(), &v4) != 0) return ntohl(v4.s_addr) >> 24 == 127;
  return inet_pton(AF_INET6, host.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

}  // namespace

std::string place_of_url(std::string_view url) {
  Place place;
  if (!find_place(url, place)) return "";
  if (place.port.empty()) place.port = url.starts_with("https://") ? "443" : "80";
  return place.host + ":" + place.port;
}

UrlTransport transport_of(std::string_view url) {
  const bool is_secure = url.starts_with("https://");
  if (!is_secure && !url.starts_with("http://")) return UrlTransport::kUnusable;
  Place place;
  if (!find_place(url, place)) return UrlTransport::kUnusable;
  if (is_secure) return UrlTransport::kSecure;
  return is_loopback(place.host) ? UrlTransport::kLoopback : UrlTransport::kOpen;
}

bool holds_login(std::string_view url) { return url_parts(url).login_bytes > 0; }

}  // namespace bess
