// Impact study: earnings of a fleet per MW by its size and price formula, with its policy
// unchanged, spread in time, with smaller steps, with a higher trading threshold, and retrained on
// prices that include the fleet; and the report.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "workstation/runs/impact/fleet_market.h"

namespace bess {

struct ImpactPlan {
  std::vector<double> fleet_mw{0, 50, 100, 200, 300, 450, 600, 800, 1200};  ///< 0: no impact
  std::vector<std::string> policies{"sdp"};  ///< equal parts of the fleet
  int train_days = 60;
  int test_days = 30;
  int seeds = 4;
  int jitter_min = 1;        ///< maximum clock delay in the spread fleet
  double step_share = 0.25;  ///< of the rated power, per two minutes
  int rounds = 3;            ///< of retraining
  int threads = 1;
};

/// Results on the test days.
struct ImpactFigures {
  double eur_per_mw_day;
  double overshoot_share;     ///< quarter-hours whose imbalance changed sign by the fleet
  double imbalance_mw;        ///< mean absolute system imbalance with the fleet
  double imbalance_alone_mw;  ///< the same without the fleet
  double switches_per_day;    ///< order changes of a battery
};

/// Means over the seeds, and the standard error of the earnings (NaN for one seed).
struct ImpactRow : ImpactFigures {
  PriceFormula formula;
  double fleet_mw;
  std::string variant;
  double standard_error;
};

/// Ordered by formula, fleet and variant. Throws UserError.
std::vector<ImpactRow> study_impact(const ImpactPlan& plan, const FleetOptions& base);

/// Policy fitted on all days of `prices`.
std::shared_ptr<Policy> fitted_policy(const std::string& name, const MinuteSeries& prices,
                                      const FleetOptions& options);

// Report of the study: table, CSV, JSON, and a page with earnings per MW by fleet size.

std::string format_impact_table(const ImpactPlan& plan, const std::vector<ImpactRow>& rows);
/// Header `formula,fleet_mw,variant,...`.
std::string impact_csv(const std::vector<ImpactRow>& rows);
Json impact_json(const ImpactPlan& plan, const std::vector<ImpactRow>& rows);
/// Writes impact.html into `folder`.
void write_impact_page(const ImpactPlan& plan, const std::vector<ImpactRow>& rows,
                       const std::filesystem::path& folder);

}  // namespace bess
