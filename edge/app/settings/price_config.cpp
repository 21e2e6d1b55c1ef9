#include "edge/app/settings/edge_config.h"

#include <unistd.h>

#include <algorithm>
#include <string>

#include "edge/core/control/price_history.h"
#include "edge/prices/record/transport_security.h"
#include "shared/units_and_limits.h"

namespace bess {

namespace {

bool is_http(std::string_view url) {
  return url.starts_with("http://") || url.starts_with("https://");
}

/// Price level at a first start, for a student whose context is the level.
void read_history(TomlTable& table, PriceConfig& price) {
  HistorySettings& history = price.history;
  table.integer("history_hours", history.hours, 0, PriceHistory::kHoursMax);
  table.text("history_url", history.url);
  if (table.has("level_start_eur_per_mwh")) {
    std::int32_t start_centi_eur_per_mwh = 0;
    table.scaled("level_start_eur_per_mwh", start_centi_eur_per_mwh, kCentiPerEur,
                 kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh);
    price.level_start_centi_eur_per_mwh = start_centi_eur_per_mwh;
  }
}

/// Unit of the source, and its numbers that mean "no price".
void read_unit(TomlTable& table, PriceFields& fields) {
  constexpr std::int32_t kEurPerMwhE1[] = {10, 10'000, 100};
  int unit = 0;
  table.choice("unit", unit, {"EUR/MWh", "EUR/kWh", "ct/kWh"});
  fields.eur_per_mwh_e1 = kEurPerMwhE1[unit];
  const TomlArray* const none = table.array("no_price");
  if (none == nullptr) return;
  for (const TomlValue& item : *none) {
    const std::optional<double> number = item.number();
    if (!number) return table.fail_at(item, "no_price must be a list of numbers");
    if (!fields.no_price.try_push_back(*number)) return table.fail("no_price", "has more than 8");
  }
}

/// Secrets are sent to only one host.
void check_history_url(TomlTable& table, const PriceConfig& price) {
  const FixedText<511>& url = price.history.url;
  if (url.empty()) return;
  if (!is_http(url.view()) || place_of_url(url.view()).empty() ||
      place_of_url(url.view()) != place_of_url(price.feed.http.url.view())) {
    table.fail("history_url", "must start with http:// or https:// and have the host of url");
  }
}

}  // namespace

void read_price(TomlTable table, PriceConfig& price) {
  PriceTransportKeys keys;
  table.require("url");
  read_price_server(table, price.feed.http, price.feed.fields, keys);
  read_unit(table, price.feed.fields);
  read_history(table, price);
  table.finish();
  if (!table.ok()) return;
  const std::string_view url = price.feed.http.url.view();
  check_history_url(table, price);
  check_price_url(table, "url", url, keys);
  if (!price.history.url.empty())
    check_price_url(table, "history_url", price.history.url.view(), keys);
  FixedText<255>& ca_file = price.feed.http.ca_file;
  keep_resolved(table, "ca_file", ca_file.view(), ca_file);
  if (url.starts_with("https://") && access(ca_file.c_str(), R_OK) != 0) {
    table.fail("ca_file", "= " + std::string(ca_file.view()) +
                              " cannot be read: install the package ca-certificates, "
                              "or set your own file");
  }
  load_headers(table, keys, price.feed.http);
}

void read_price_server(TomlTable& table, HttpSettings& http, PriceFields& fields,
                       PriceTransportKeys& keys) {
  table.text("url", http.url);
  table.text("ca_file", http.ca_file);
  table.text("header_file", keys.header_file);
  table.text("rows_field", fields.rows);
  table.text("time_field", fields.time);
  table.text("price_field", fields.price);
  table.boolean("allow_http", keys.allow_http);
}

void load_headers(TomlTable& table, const PriceTransportKeys& keys, HttpSettings& http) {
  if (keys.header_file.empty() || !table.ok()) return;
  load_http_headers(table.resolved(keys.header_file.view()).c_str(), http.headers, table.error());
}

void check_price_url(TomlTable& table, std::string_view key, std::string_view url,
                     const PriceTransportKeys& keys) {
  const UrlTransport transport = transport_of(url);
  if (transport == UrlTransport::kUnusable) {
    return table.fail(key, "must start with http:// or https:// and name a host");
  }
  if (transport == UrlTransport::kSecure) return;
  // Also on loopback: while the server is down, any user can listen on its port.
  if (!keys.header_file.empty()) {
    return table.fail("header_file",
                      "has secrets, which are never sent over plain HTTP: use an https:// url, or "
                      "remove header_file");
  }
  if (holds_login(url)) {
    return table.fail(key,
                      "has a user or a password, which are never sent over plain HTTP: use "
                      "https://, or remove them");
  }
  if (transport == UrlTransport::kOpen && !keys.allow_http) {
    table.fail(key,
               "is plain HTTP (http://) to another host: prices could be forged in transit; use "
               "https://, or add allow_http = true (127.0.0.1 and [::1] need no key)");
  }
}

SettingsNote transport_note(const PriceConfig& price) {
  UrlTransport weakest = transport_of(price.feed.http.url.view());
  if (!price.history.url.empty()) {
    weakest = std::max(weakest, transport_of(price.history.url.view()));
  }
  if (weakest == UrlTransport::kSecure) return {.text = "https"};
  if (weakest == UrlTransport::kLoopback) return {.text = "plain http on this machine"};
  return {.is_warning = true,
          .text = "prices come over plain http (allow_http) and could be forged in transit"};
}

}  // namespace bess
