// What is to be weighed up before a battery is bought: powers x capacities x contracts, what buying
// costs and how it ages. A TOML file; README.md has an example with every key.
#pragma once

#include <string>
#include <vector>

#include "workstation/chain/run_config.h"

namespace bess {

/// What trading costs, and what whoever lets one trade keeps.
struct SizeContract {
  std::string name;
  TradingCosts costs;  ///< these and the next two change what is decided
  double wear_eur_per_mwh = 0;
  double cycles_per_day_max = 0;
  double share_percent = 0;  ///< of what a month earns; of a month's loss nothing
  double fee_eur_per_month = 0;
  double capacity_eur_per_kw_year = 0;  ///< on the mean of the months' highest quarter-hours taken
  double capacity_free_kw = 0;          ///< of it, that the site pays for anyway
};

/// What a battery costs. All 0: nothing is said of paying back.
struct Purchase {
  double eur = 0, eur_per_kw = 0, eur_per_kwh = 0;

  [[nodiscard]] double price_eur(double power_w, double capacity_wh) const {
    return eur + eur_per_kw * power_w / 1e3 + eur_per_kwh * capacity_wh / 1e3;
  }
};

/// Capacity that is lost, of what was bought: so much a year in any case, and so much by use. Data
/// sheets of LFP promise 80 % after 6,000 cycles (3.3 % a thousand); with 1 % a year beside it a
/// battery of one cycle a day has 78 % after ten years, inside of the 8 to 15 years to 70 or 80 %
/// that a survey of home batteries reports (cleanenergyreviews.info, "Battery life explained").
struct Ageing {
  double calendar_percent_per_year = 1;
  double cycle_percent_per_1000 = 3.3;  ///< equivalent full cycles of the capacity bought
  double end_percent = 70;              ///< of that capacity: then it is replaced
};

struct SizePlan {
  std::vector<double> power_w, capacity_wh;
  std::vector<SizeContract> contracts;  ///< not empty
  Purchase purchase;
  Ageing ageing;
  std::string policy = "sdp";
  int window_days = 120;
};

/// `base` is the configuration that all cells have in common: what a contract does not name is as
/// there. Throws UserError naming file and line.
SizePlan read_size_plan(const std::string& path, const RunConfig& base);

}  // namespace bess
