// What of the configuration counts money: [contract], where [settled] keeps its prices, and the
// capacity of a battery that does not tell its own. Read apart from the controller's settings,
// which a slip here must not touch.
#pragma once

#include <cstdint>
#include <string>

#include "edge/account/contract.h"
#include "edge/account/settled_prices.h"

namespace bess {

struct MoneySettings {
  Contract contract{};
  std::int32_t capacity_wh = 8'000;  ///< [battery] capacity_wh
  std::string settled_file;          ///< of bess-prices; there may be none
};

/// `root` is the whole configuration.
MoneySettings read_money_settings(TomlTable& root);
/// False with one line: file, key, and the mend.
bool load_money_settings(const std::string& path, MoneySettings& settings, std::string& error);

/// What is counted with.
struct MoneyTerms {
  Contract contract{};
  SettledPrices settled{};
  std::int32_t capacity_wh = 0;  ///< of a device that tells none
};
/// With what lies in the file of settled prices; `trouble` is one line when that cannot be read.
MoneyTerms money_terms(const MoneySettings& settings, std::string& trouble);

}  // namespace bess
