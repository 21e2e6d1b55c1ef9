#include "edge/account/contract.h"

#include "shared/exchange_cost.h"
#include "shared/host/text.h"

namespace bess {

BatteryParameters Contract::applied_to(BatteryParameters battery) const {
  battery.costs = costs;
  battery.wear_eur_per_mwh = wear_eur_per_mwh;
  return battery;
}

double Contract::costs_eur(double energy_mwh, double price_eur_per_mwh) const {
  return exchange_cost_eur(applied_to({}), energy_mwh, price_eur_per_mwh) -
         energy_mwh * price_eur_per_mwh;
}

bool Contract::is_free() const {
  return costs.import_adder_eur_per_mwh == 0 && costs.import_percent == 0 &&
         costs.export_fee_eur_per_mwh == 0 && costs.export_percent == 0 && wear_eur_per_mwh == 0;
}

std::string Contract::text() const {
  if (is_free()) return "none";
  return formatted("import %g EUR/MWh and %g %%, export %g EUR/MWh and %g %%, wear %g EUR/MWh",
                   costs.import_adder_eur_per_mwh, costs.import_percent,
                   costs.export_fee_eur_per_mwh, costs.export_percent, wear_eur_per_mwh);
}

Json Contract::json() const {
  return Json::object({{"import_adder_eur_per_mwh", costs.import_adder_eur_per_mwh},
                       {"import_percent", costs.import_percent},
                       {"export_fee_eur_per_mwh", costs.export_fee_eur_per_mwh},
                       {"export_percent", costs.export_percent},
                       {"wear_eur_per_mwh", wear_eur_per_mwh}});
}

void read_contract(TomlTable table, Contract& contract) {
  TradingCosts& costs = contract.costs;
  table.number("import_adder_eur_per_mwh", costs.import_adder_eur_per_mwh, 0, 1'000);
  table.number("import_percent", costs.import_percent, 0, 100);
  table.number("export_fee_eur_per_mwh", costs.export_fee_eur_per_mwh, 0, 1'000);
  table.number("export_percent", costs.export_percent, 0, 100);
  table.number("wear_eur_per_mwh", contract.wear_eur_per_mwh, 0, 1'000);
  table.finish();
}

}  // namespace bess
