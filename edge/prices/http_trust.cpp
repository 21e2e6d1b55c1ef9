#include "edge/prices/http_trust.h"

#include <string>

#include "edge/prices/host_addresses.h"
#include "edge/prices/http_secrets.h"

namespace bess {

UrlTransport transport_of(std::string_view url) {
  const bool is_secure = url.starts_with("https://");
  HostAddresses host;
  const bool is_usable = (is_secure || url.starts_with("http://")) &&
                         host.set_url(std::string(url).c_str()) == Status::kOk;
  if (!is_usable) return UrlTransport::kUnusable;
  if (is_secure) return UrlTransport::kSecure;
  return host.is_loopback() ? UrlTransport::kLoopback : UrlTransport::kOpen;
}

bool holds_login(std::string_view url) { return url_parts(url).login_bytes > 0; }

}  // namespace bess
