#include "edge/settings/price_transport.h"

#include <algorithm>

#include "edge/prices/http_trust.h"

namespace bess {
void check_price_url(TomlTable& table, std::string_view key, std::string_view url,
                     const PriceTransportKeys& keys) {
  const UrlTransport transport = transport_of(url);
  if (transport == UrlTransport::kUnusable) {
    return table.fail(key, "must start with http:// or https:// and name a host");
  }
  if (transport == UrlTransport::kSecure) return;
  // Inside this machine as well: while the server is down, any user may listen at its port.
  if (keys.has_header_file) {
    return table.fail("header_file",
                      "holds secrets, which are never sent over plain http: use an https:// url, "
                      "or leave header_file out");
  }
  if (holds_login(url)) {
    return table.fail(key,
                      "holds a user or a password, which are never sent over plain http: use "
                      "https://, or leave them out");
  }
  if (transport == UrlTransport::kOpen && !keys.allow_http) {
    table.fail(key,
               "is plain http to another machine: whoever is on the way can write the prices; use "
               "https://, or add allow_http = true (127.0.0.1 and [::1] need no key)");
  }
}

void check_price_transport(TomlTable& table, const PriceSources& sources,
                           const PriceTransportKeys& keys) {
  check_price_url(table, "url", sources.price.http.url.view(), keys);
  if (!sources.history.url.empty())
    check_price_url(table, "history_url", sources.history.url.view(), keys);
}

TransportNote transport_note(const PriceSources& sources) {
  UrlTransport weakest = transport_of(sources.price.http.url.view());
  if (!sources.history.url.empty()) {
    weakest = std::max(weakest, transport_of(sources.history.url.view()));
  }
  switch (weakest) {
    case UrlTransport::kSecure:
      return {.text = "https"};
    case UrlTransport::kLoopback:
      return {.text = "plain http inside this machine"};
    case UrlTransport::kOpen:
    case UrlTransport::kUnusable:
      break;
  }
  return {.is_open = true,
          .text = "prices come over plain http (allow_http): whoever is on the way can write them"};
}

}  // namespace bess
