// What the contract adds to the price, by section [contract] of the configuration: the same keys,
// ranges and arithmetic as [costs] and wear of the workstation, so that what was learned for is
// what is billed. The controller knows nothing of it: a slip there must not keep it from driving.
#pragma once

#include <string>

#include "shared/battery_model.h"
#include "shared/host/json.h"
#include "shared/host/toml_reader.h"

namespace bess {

struct Contract {
  TradingCosts costs{};
  double wear_eur_per_mwh = 0;

  /// That battery, with what using it costs.
  [[nodiscard]] BatteryParameters applied_to(BatteryParameters battery) const;
  /// What exchanging costs beside the price itself; `energy_mwh` grid side, charge positive.
  [[nodiscard]] double costs_eur(double energy_mwh, double price_eur_per_mwh) const;
  [[nodiscard]] bool is_free() const;
  /// "import 45.00 EUR/MWh and 2 %, ..."; "none".
  [[nodiscard]] std::string text() const;
  [[nodiscard]] Json json() const;
};

void read_contract(TomlTable table, Contract& contract);

}  // namespace bess
