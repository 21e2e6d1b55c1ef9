// Simulated market with a fleet: its exchange changes the system imbalance and the activated bids,
// and both determine the next minute's price, which the fleet sees after publication. Without
// impact, prices are bit-identical to the simulated market.
//
// A merit order without memory: each MW of shortage raises the marginal price of upward bids by
// 0.19 EUR/MWh, each of surplus lowers that of downward bids by 0.28. (ods047, 13,650 quarter-hours
// of 1 January to 23 May 2023, regression within days: 7,960 short ones up to 600 EUR/MWh, and
// 5,656 long ones.) Reactions of other participants are not modelled.
//
// Price formulas:
//   marginal      until 21 May 2024: last bid and alpha
//   (../data/market/series/imbalance_price.h)
//   mean          since: mean of the activated bids, here half-way from the first to the last
//                 of a straight merit order; at least the first bids of either side when short, at
//                 most when long; within 25 MW their middle
//   mean+alpha    the same with alpha outside the dead band, as published in ods161
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "shared/battery_model.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/data/env/policy.h"
#include "workstation/data/market/model/simulated_market.h"

namespace bess {

enum class PriceFormula : std::uint8_t { kMarginal, kMean, kMeanWithAlpha };
inline constexpr std::array<std::string_view, 3> kFormulaNames{"marginal", "mean", "mean+alpha"};

/// Consecutive drawn quarter-hours and their minute paths.
struct DrawnMarket {
  std::vector<QuarterHour> quarter_hours;
  std::vector<MinutePath> paths;
};
DrawnMarket draw_market(std::int64_t start_utc_s, int days, std::uint64_t seed);

/// Price of a minute in whole cents, with an additional surplus of `fleet_mw` in this quarter-hour
/// so far and `previous_fleet_mw` in the previous one.
double fleet_price(PriceFormula formula, const MinutePath& path, int minute, bool settled_short,
                   double fleet_mw, double previous_fleet_mw);

/// Batteries with the same policy.
struct FleetPart {
  std::shared_ptr<Policy> policy;
  double share;           ///< of the fleet's power
  int late_min = 0;       ///< delay of their clock and prices
  double step_share = 2;  ///< maximum change of an order, share of rated power; 2: no limit
};

struct FleetOptions {
  BatteryParameters battery;  ///< one battery; only its C-rate matters
  double initial_soc_frac = 0.5;
  int observation_delay_min = 1;  ///< 1..5: delay until the fleet sees a price
  PriceFormula formula = PriceFormula::kMarginal;
  double fleet_mw = 0;  ///< 0: no impact
  std::size_t first_quarter_hour = 0;
};

struct FleetRun {
  std::vector<Evaluation> parts;     ///< one battery of each part, days in order
  MinuteSeries prices;               ///< resulting prices
  std::vector<double> imbalance_mw;  ///< [quarter-hour] with the fleet
};

/// Runs all quarter-hours. Days are local; the last one may be incomplete.
FleetRun run_fleet(const DrawnMarket& market, const std::vector<FleetPart>& fleet,
                   const FleetOptions& options);

}  // namespace bess
