// The simulated market when a fleet answers its prices: what it exchanges moves the system's
// imbalance, that moves the bids that are activated, and both make the next minute's price, which
// the fleet sees when it is published. Without impact it is today's market, to the bit.
//
// A merit order without memory: each MW of shortage raises the marginal price of upward bids by
// 0.19 EUR/MWh, each of surplus lowers that of downward bids by 0.28. (ods047, 13,650 quarter-hours
// of 1 January to 23 May 2023, regression within days: 7,960 short ones up to 600 EUR/MWh, and
// 5,656 long ones.) Who else would answer such prices is not in it.
//
// Three ways to make a price of it:
//   marginal      until 21 May 2024: the last bid, and alpha
//   (../data/market/series/imbalance_price.h)
//   mean          since: the mean of the activated bids, here half-way from the first to the last
//                 of a straight merit order; at least the first bids of either side when short, at
//                 most when long; within 25 MW their middle
//   mean+alpha    the same with alpha beyond the dead band, as ods161 has published it since
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "shared/battery_model.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/data/env/policy.h"
#include "workstation/data/market/model/minute_path.h"

namespace bess {

enum class PriceFormula : std::uint8_t { kMarginal, kMean, kMeanWithAlpha };
inline constexpr std::array<std::string_view, 3> kFormulaNames{"marginal", "mean", "mean+alpha"};

/// Drawn quarter-hours, one after the other, and their paths: what the fleet meets.
struct DrawnMarket {
  std::vector<QuarterHour> quarter_hours;
  std::vector<MinutePath> paths;
};
DrawnMarket draw_market(std::int64_t start_utc_s, int days, std::uint64_t seed);

/// The price of a minute in whole cents, with `fleet_mw` more of surplus in the quarter-hour so far
/// and `previous_fleet_mw` in the one before.
double fleet_price(PriceFormula formula, const MinutePath& path, int minute, bool settled_short,
                   double fleet_mw, double previous_fleet_mw);

/// Batteries that decide alike. How many they are is their power's matter.
struct FleetPart {
  std::shared_ptr<Policy> policy;
  double share;           ///< of the fleet's power
  int late_min = 0;       ///< their clock, and what they see, is so much later
  double step_share = 2;  ///< of the rated power that an order may differ by; 2 is all of it
};

struct FleetOptions {
  BatteryParameters battery;  ///< of one of them; only its C-rate matters to the market
  double initial_soc_frac = 0.5;
  int observation_delay_min = 1;  ///< 1..5: a row that the fleet makes is seen after it
  PriceFormula formula = PriceFormula::kMarginal;
  double fleet_mw = 0;  ///< 0: what one battery does moves nothing
  std::size_t first_quarter_hour = 0;
};

struct FleetRun {
  std::vector<Evaluation> parts;     ///< one battery of each part, days in order
  MinuteSeries prices;               ///< that were made
  std::vector<double> imbalance_mw;  ///< [quarter-hour] with the fleet
};

/// From the first quarter-hour to the last. Days are local; the last one may be cut.
FleetRun run_fleet(const DrawnMarket& market, const std::vector<FleetPart>& fleet,
                   const FleetOptions& options);

}  // namespace bess
