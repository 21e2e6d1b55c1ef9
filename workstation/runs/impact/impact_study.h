// Earnings of a fleet per MW as it grows, by price formula: with its policy unchanged, spread in
// time, with smaller steps, with a higher threshold for trades, and retrained on the prices that it
// made itself; and their report.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "workstation/runs/impact/fleet_market.h"

namespace bess {

struct ImpactPlan {
  std::vector<double> fleet_mw{0, 50, 100, 200, 300, 450, 600, 800, 1200};  ///< 0: nothing is moved
  std::vector<std::string> policies{"sdp"};  ///< each has an equal part of the fleet
  int train_days = 60;
  int test_days = 30;
  int seeds = 4;
  int jitter_min = 1;        ///< clocks of the spread fleet are 0 .. so much late
  double step_share = 0.25;  ///< of the rated power, each two minutes
  int rounds = 3;            ///< of learning anew
  int threads = 1;
};

/// One way to run the fleet.
struct ImpactVariant {
  std::string name;
  bool is_spread = false, has_small_steps = false;
  bool is_shy = false;  ///< plans with more wear than there is, as was best on the training days
  int round = 0;        ///< times that it was learnt anew
};
/// "as it is", "spread in time", "small steps", "shy", "round 1", ...
std::vector<ImpactVariant> impact_variants(const ImpactPlan& plan);

/// Of the test days.
struct ImpactFigures {
  double eur_per_mw_day;
  double overshoot_share;     ///< quarter-hours that the fleet turned to the other side
  double imbalance_mw;        ///< mean size of the system's imbalance with the fleet
  double imbalance_alone_mw;  ///< and without
  double switches_per_day;    ///< of a battery's orders
};

/// Means over the seeds, and the standard error of the money (NaN of one seed).
struct ImpactRow {
  PriceFormula formula;
  double fleet_mw;
  std::string variant;
  ImpactFigures mean;
  double standard_error;
};

/// By formula, fleet and variant. Throws UserError.
std::vector<ImpactRow> study_impact(const ImpactPlan& plan, const FleetOptions& base);

/// Fitted on all days of `prices`.
std::shared_ptr<Policy> fitted_policy(const std::string& name, const MinuteSeries& prices,
                                      const FleetOptions& options);

// What came of a fleet's own impact: a table for the terminal, CSV, JSON, and a page with the money
// a MW over the fleet's size.

std::string format_impact_table(const ImpactPlan& plan, const std::vector<ImpactRow>& rows);
/// Header `formula,fleet_mw,variant,...`.
std::string impact_csv(const std::vector<ImpactRow>& rows);
Json impact_json(const ImpactPlan& plan, const std::vector<ImpactRow>& rows);
/// Writes impact.html into `folder`.
void write_impact_page(const ImpactPlan& plan, const std::vector<ImpactRow>& rows,
                       const std::filesystem::path& folder);

}  // namespace bess
