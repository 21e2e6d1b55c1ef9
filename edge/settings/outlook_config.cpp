#include "edge/settings/outlook_config.h"

#include <string>

#include "edge/prices/http_secrets.h"
#include "edge/settings/price_transport.h"

namespace bess {

void read_outlook(TomlTable table, OutlookSettings& outlook) {
  FixedText<255> header_file;
  PriceTransportKeys transport;
  table.text("url", outlook.http.url);
  table.text("file", outlook.file);
  table.text("ca_file", outlook.http.ca_file);
  table.text("header_file", header_file);
  table.text("rows_field", outlook.fields.rows);
  table.text("time_field", outlook.fields.time);
  table.text("price_field", outlook.fields.price);
  table.boolean("allow_http", transport.allow_http);
  table.finish();
  if (!table.ok() || table.value() == nullptr) return;
  if (table.has("url") && table.has("file")) {
    return table.fail("file", "and url are two sources: leave one of them out");
  }
  if (!outlook.file.empty()) {
    if (!outlook.file.assign(table.resolved(outlook.file.view()))) {
      table.fail("file", "is too long a path");
    }
    return;
  }
  transport.has_header_file = !header_file.empty();
  check_price_url(table, "url", outlook.http.url.view(), transport);
  if (!outlook.http.ca_file.assign(table.resolved(outlook.http.ca_file.view()))) {
    table.fail("ca_file", "is too long a path");
  }
  if (header_file.empty() || !table.ok()) return;
  load_http_headers(table.resolved(header_file.view()).c_str(), outlook.http.headers,
                    table.error());
}

}  // namespace bess
