// What a learned policy is held against, one row each: whoever lists baselines, in a command's
// help, in a table, on the page or in a test, iterates these rows. Adding one is its file beside
// this one and a row in baselines.cpp.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/battery_model.h"
#include "workstation/env/policy.h"

namespace bess {

inline constexpr const char* kForesightName = "foresight";  ///< the bound, no policy
inline constexpr const char* kProgramName = "sdp";          ///< what a teacher begins as

/// Where a baseline stands, besides `evaluate`, which takes them all.
enum BaselineUse : unsigned {
  kFitted = 1,           ///< on the training days
  kInRuns = 2,           ///< in the table of each run, as in that of the walk-forward's page
  kUnlessToldOther = 4,  ///< what `backtest` compares
  kNeedsDayAhead = 8     ///< plans on day-ahead prices, which must be given
};

struct Baseline {
  std::string name;
  std::string help;  ///< behind the name; empty: it says everything
  std::string
      meaning;  ///< beside the exported policy, in headline and pictures; empty: not shown there
  std::string colour;  ///< of its line on the page, a variable of report.css
  unsigned uses;       ///< of BaselineUse
  std::shared_ptr<Policy> (*make)(const MarketSteps& market, const BatteryParameters& battery);

  [[nodiscard]] bool is_for(BaselineUse use) const { return (uses & use) != 0; }
};

/// In the order of tables; foresight is the last.
std::span<const Baseline> baselines();
std::vector<std::string> baseline_names(BaselineUse use);
/// Those that are shown beside the exported policy: the first says most.
std::vector<std::string> rival_names();

/// "rbc:11:179", which is no row: its thresholds are given, EUR/MWh.
inline constexpr std::string_view kGivenRule = "rbc:";
std::shared_ptr<Policy> given_rule(const std::string& name);

/// None when there is no such row.
const Baseline* find_baseline(std::string_view name);
/// By its row, or a given rule; null for another name. What is fitted is fitted on the training
/// days of `market`, which may differ in its delay from the market that it runs on. Throws
/// UserError.
std::shared_ptr<Policy> make_baseline(const std::string& name, const MarketSteps& market,
                                      const BatteryParameters& battery);

}  // namespace bess
