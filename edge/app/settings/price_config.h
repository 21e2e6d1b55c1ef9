// [price]: whom to ask for prices, how, and what a first start knows of those before.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "edge/prices/record/price_settings.h"
#include "shared/host/toml_reader.h"

namespace bess {

struct PriceConfig {
  PriceFeedSettings feed;
  HistorySettings history;
  std::optional<std::int32_t> level_start_centi_eur_per_mwh;
};

void read_price(TomlTable table, PriceConfig& price);

// Over what prices come, and what may be sent for them: refused at the start where the
// configuration does not allow it, told where it does.

/// Where prices come from.
struct PriceSources {
  const PriceFeedSettings& price;
  const HistorySettings& history;
};

/// What the operator says about the way of the requests.
struct PriceTransportKeys {
  bool allow_http = false;
  bool has_header_file = false;  ///< secrets are sent with every request
};

/// Complains, with the mend, of a URL that is none, of plain http that is not allowed, and of
/// secrets on plain http.
void check_price_url(TomlTable& table, std::string_view key, std::string_view url,
                     const PriceTransportKeys& keys);

/// The same of each URL of [price].
void check_price_transport(TomlTable& table, const PriceSources& sources,
                           const PriceTransportKeys& keys);

struct TransportNote {
  bool is_open = false;  ///< somebody else could write the prices
  std::string text;
};

/// One line about the transport of url and history_url, the weaker one of them.
TransportNote transport_note(const PriceSources& sources);

}  // namespace bess
