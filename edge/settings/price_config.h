// [price]: whom to ask for prices, how, and what a first start knows of those before.
#pragma once

#include <cstdint>
#include <optional>

#include "edge/prices/price_settings.h"
#include "shared/host/toml_reader.h"

namespace bess {

struct PriceConfig {
  PriceFeedSettings feed;
  HistorySettings history;
  std::optional<std::int32_t> level_start_centi_eur_per_mwh;
};

void read_price(TomlTable table, PriceConfig& price);

}  // namespace bess
