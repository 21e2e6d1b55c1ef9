#include "edge/settings/price_config.h"

#include <unistd.h>

#include <string>

#include "edge/prices/http_secrets.h"
#include "edge/settings/price_transport.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

bool is_http(std::string_view url) {
  return url.starts_with("http://") || url.starts_with("https://");
}

/// How a student by level is given the level at a first start.
void read_history(TomlTable& table, PriceConfig& price) {
  HistorySettings& history = price.history;
  table.integer("history_hours", history.hours, 0, PriceHistory::kHoursMax);
  table.integer("history_wait_s", history.wait_s, 1, 3'600);
  table.text("history_url", history.url);
  if (table.has("level_start_eur_per_mwh")) {
    std::int32_t start_centi_eur_per_mwh = 0;
    table.scaled("level_start_eur_per_mwh", start_centi_eur_per_mwh, kCentiPerEur,
                 kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh);
    price.level_start_centi_eur_per_mwh = start_centi_eur_per_mwh;
  }
}

/// Names are looked up, and secrets sent, for one host alone.
void check_history_url(TomlTable& table, const PriceConfig& price) {
  const FixedText<511>& url = price.history.url;
  if (url.empty()) return;
  HostAddresses here;
  HostAddresses there;
  const bool is_known = here.set_url(price.feed.http.url.c_str()) == Status::kOk &&
                        there.set_url(url.c_str()) == Status::kOk;
  if (!is_http(url.view()) || !is_known || !there.is_same_host(here)) {
    table.fail("history_url", "must start with http:// or https:// and be of the host of url");
  }
}

}  // namespace

void read_price(TomlTable table, PriceConfig& price, FrozenPriceSettings& frozen) {
  FixedText<255> header_file;
  PriceTransportKeys transport;
  table.require("url");
  table.text("url", price.feed.http.url);
  table.text("ca_file", price.feed.http.ca_file);
  table.text("header_file", header_file);
  table.text("rows_field", price.feed.fields.rows);
  table.text("time_field", price.feed.fields.time);
  table.text("price_field", price.feed.fields.price);
  table.integer("timeout_ms", price.feed.http.timeout_ms, 10, 60'000);
  table.integer("resolve_every_s", price.feed.http.resolve_every_s, 1, 86'400);
  table.integer("requests_per_cycle", price.feed.requests_per_cycle, 1, 4);
  table.integer("wait_s", price.feed.wait_s, 1, 60);
  table.scaled("step_flag_eur_per_mwh", price.feed.step_flag_centi_eur_per_mwh, kCentiPerEur, 0,
               2 * kPlausiblePriceMaxEurPerMwh);
  table.integer("frozen_price_s", frozen.frozen_s, 0, 86'400);
  read_history(table, price);
  table.boolean("allow_http", transport.allow_http);
  table.boolean("hold_flagged_step", price.feed.hold_flagged_step);
  table.finish();
  if (!table.ok()) return;
  const std::string_view url = price.feed.http.url.view();
  check_history_url(table, price);
  transport.has_header_file = !header_file.empty();
  check_price_transport(table, {price.feed, price.history}, transport);
  const std::string ca_file = table.resolved(price.feed.http.ca_file.view());
  if (!price.feed.http.ca_file.assign(ca_file)) table.fail("ca_file", "is too long a path");
  if (url.starts_with("https://") && access(price.feed.http.ca_file.c_str(), R_OK) != 0) {
    table.fail("ca_file", "= " + ca_file +
                              " cannot be read: install the package ca-certificates, "
                              "or name your own file");
  }
  if (header_file.empty() || !table.ok()) return;
  load_http_headers(table.resolved(header_file.view()).c_str(), price.feed.http.headers,
                    table.error());
}

}  // namespace bess
