// Baselines that a learned policy is compared with, one row each: commands, tables, page and tests
// iterate these rows. A new one is a row in baselines.cpp. With the tuned rule and the tabular
// learner.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/battery_model.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/data/env/policy.h"

namespace bess {

// Tabular value iteration: the classical baseline that fits in two seconds [SPEC 8].
// State: phase of the half-hour (15), bin of the observed price (48 quantile bins of the training
// decisions), SoC (181 points). The price is a Markov chain from (phase, bin) to the next phase's
// bin, counted on training days; the reward is the mean import or export price in each (phase,
// bin). gamma 0.999, continuing.

class TabularPolicy final : public Policy {
 public:
  /// Fits on `days` of `market`; throws UserError when there are none.
  TabularPolicy(const MarketSteps& market, const std::vector<MarketDay>& days,
                const BatteryParameters& battery);
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override;

 private:
  [[nodiscard]] int price_bin(double price_eur_per_mwh) const;
  void count_market(const MarketSteps& market, const std::vector<MarketDay>& days);
  void iterate_values();

  BatteryParameters battery_;
  std::vector<double> bin_edges_;  ///< [47] ascending
  std::vector<double> import_;  ///< [phase][bin] mean price of a MWh taken, trading costs included
  std::vector<double> export_;  ///< the same of a MWh given
  std::vector<float> transition_;  ///< [phase][bin][next bin] probability
  std::vector<Action> greedy_;     ///< [phase][bin][SoC point]
};

// The rule-based controller at its best: both thresholds chosen to earn most on the training days,
// days chained so that the first one's charge is not given away at each midnight [SPEC 4]. What a
// careful user would get without any learning, and so the fair peer of everything that learns.

struct RuleThresholds {
  double low_eur_per_mwh;   ///< charge below
  double high_eur_per_mwh;  ///< discharge above
};

/// Throws UserError when there are no training days in `days`.
RuleThresholds tune_rule(const MarketSteps& market, const std::vector<MarketDay>& days,
                         const BatteryParameters& battery);

inline constexpr const char* kForesightName = "foresight";         ///< the bound, no policy
inline constexpr const char* kProgramName = "sdp";                 ///< what a teacher begins as
inline constexpr const char* kOutlookProgramName = "sdp-outlook";  ///< and by outlook

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
