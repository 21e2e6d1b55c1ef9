// What of the configuration counts money: where bess-prices keeps settled prices, and the capacity
// of a battery that does not tell its own. Read apart from the controller's settings.
#pragma once

#include <cstdint>
#include <string>

#include "edge/account/settled_prices.h"
#include "shared/host/toml_reader.h"

namespace bess {

struct MoneySettings {
  std::int32_t capacity_wh = 8'000;  ///< [battery] capacity_wh
  std::string settled_file;          ///< of bess-prices; there may be none
};

/// `root` is the whole configuration, whose slips others name.
MoneySettings read_money_settings(TomlTable& root);

/// What is counted with.
struct MoneyTerms {
  SettledPrices settled{};
  std::int32_t capacity_wh = 0;  ///< of a device that tells none
};
/// With what lies in the file of settled prices; `trouble` is one line when that cannot be read.
MoneyTerms money_terms(const MoneySettings& settings, std::string& trouble);

}  // namespace bess
