// Reader of [price]: source, transport, and price level at a first start.
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

/// Keeps the path of the key, relative to the folder of the file.
template <int kCapacity>
void keep_resolved(TomlTable& table, std::string_view key, std::string_view path,
                   FixedText<kCapacity>& kept) {
  if (!kept.assign(table.resolved(path))) table.fail(key, "is too long a path");
}

// Keys of a price server, the same in [price] and [outlook].

/// Operator's settings of the transport.
struct PriceTransportKeys {
  bool allow_http = false;
  FixedText<255> header_file;  ///< secrets that are sent with every request; empty = none
};

void read_price_server(TomlTable& table, HttpSettings& http, PriceFields& fields,
                       PriceTransportKeys& keys);

/// Rejects a malformed URL, plain HTTP that is not allowed, and secrets over plain HTTP.
void check_price_url(TomlTable& table, std::string_view key, std::string_view url,
                     const PriceTransportKeys& keys);

/// Loads the header file, if any, after all other checks.
void load_headers(TomlTable& table, const PriceTransportKeys& keys, HttpSettings& http);

/// Remark on settings, one line.
struct SettingsNote {
  bool is_warning = false;
  std::string text{};
};

/// The weaker transport of url and history_url; a warning if prices could be forged in transit.
SettingsNote transport_note(const PriceConfig& price);

}  // namespace bess
