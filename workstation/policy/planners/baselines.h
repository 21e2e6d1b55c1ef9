// Baselines to compare learned policies with, one row each: commands, tables, page and tests
// iterate these rows. A new one is a row in baselines.cpp. Also the tuned rule and the tabular
// learner.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/battery_model.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/data/env/policy.h"
#include "workstation/policy/planners/foresight.h"

namespace bess {

// Rolling-horizon control (model-predictive) on a naive forecast. At every step it plans the next
// 24 hours by dynamic programming at forecast prices and executes the first action. Like any policy
// it knows the newest published price and its age.
//
// Forecast (persistence), with d = newest price - usual price of its quarter-hour:
//   rest of this quarter-hour   usual + s d        s: by minute of the quarter-hour, least squares
//   k quarter-hours later       usual + s d rho^k
// usual = mean settled price of the training days by quarter-hour of day; rho = their lag-1
// autocorrelation by quarter-hours. The deviation of a row older than usual decays further by rho.
//
// The forecast of later quarter-hours depends only on the quarter-hour of day and its deviation, so
// the value by SoC is tabulated once and replanning takes at most eight sweeps:
//   V_h(q, d) = sweep over the steps of q at usual(q) + d  of  V_{h-1}(q + 1, rho d),   V_0 = 0

class RollingHorizonPolicy final : public Policy {
 public:
  /// Fits the forecast on `days` of `market`; throws UserError without days.
  RollingHorizonPolicy(const MarketSteps& market, const std::vector<MarketDay>& days,
                       const BatteryParameters& battery);
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override;

  /// Expected profit, EUR, at `kSocPoints` even points of the SoC window.
  static constexpr int kSocPoints = 121;
  using Values = std::array<float, kSocPoints>;

 private:
  /// Of the newest price.
  [[nodiscard]] double observed_deviation(const MarketStep& step) const;
  [[nodiscard]] double deviation_now(const MarketStep& step) const;
  void fit_usual_prices(const MarketSteps& market, const std::vector<MarketDay>& days);
  void fit_persistence(const MarketSteps& market, const std::vector<MarketDay>& days);
  void fit_shrinkage(const MarketSteps& market, const std::vector<MarketDay>& days);
  void tabulate_values();
  /// Value by SoC with `steps` more steps of this quarter-hour, then `later` (laid out as value_).
  [[nodiscard]] Values plan(const std::vector<float>& later, int quarter_hour, double deviation,
                            int steps) const;

  BatteryParameters battery_;
  SocGrid grid_;
  BellmanSweep sweep_;
  std::array<double, kQuarterHourCount> usual_eur_per_mwh_{};
  std::array<double, kMinutesPerQuarterHour> shrinkage_{};  ///< s
  std::array<int, kMinutesPerQuarterHour>
      ordinary_age_quarter_hours_{};  ///< in quarter-hours, of the training days
  double persistence_ = 0;            ///< rho
  std::vector<float> value_;          ///< [quarter-hour][deviation][SoC point] EUR
};

// Tabular value iteration: the classical baseline, fitted in two seconds [SPEC 8].
// State: phase of the half-hour (15), bin of the observed price (48 quantile bins of the training
// decisions), SoC (181 points). The price is a Markov chain from (phase, bin) to the next phase's
// bin, counted on training days; the reward is the mean import or export price in each (phase,
// bin). gamma 0.999, continuing.

class TabularPolicy final : public Policy {
 public:
  /// Fits on `days` of `market`; throws UserError without days.
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
  std::vector<double> import_;     ///< [phase][bin] mean import price with trading costs, EUR/MWh
  std::vector<double> export_;     ///< the same for export
  std::vector<float> transition_;  ///< [phase][bin][next bin] probability
  std::vector<Action> greedy_;     ///< [phase][bin][SoC point]
};

// Tuned rule-based control: both thresholds with the highest profit on the training days, SoC
// carried over so that final charge has value [SPEC 4]. The best result without learning, and
// therefore the comparison for learned policies.

struct RuleThresholds {
  double low_eur_per_mwh;   ///< charge below
  double high_eur_per_mwh;  ///< discharge above
};

/// Throws UserError without training days in `days`.
RuleThresholds tune_rule(const MarketSteps& market, const std::vector<MarketDay>& days,
                         const BatteryParameters& battery);

inline constexpr const char* kForesightName = "foresight";         ///< a bound, not a policy
inline constexpr const char* kProgramName = "sdp";                 ///< initial policy of a teacher
inline constexpr const char* kOutlookProgramName = "sdp-outlook";  ///< the same, by outlook

/// Uses of a baseline in addition to `evaluate`, which takes all.
enum BaselineUse : unsigned {
  kFitted = 1,           ///< fitted on the training days
  kInRuns = 2,           ///< in the tables of runs and walk-forward page
  kUnlessToldOther = 4,  ///< default of `backtest`
  kNeedsDayAhead = 8     ///< needs day-ahead prices
};

struct Baseline {
  std::string name;
  std::string help;  ///< after the name; empty: the name suffices
  std::string
      meaning;  ///< in headline and figures next to the exported policy; empty: not shown there
  std::string colour;  ///< of its line on the page, a variable of report.css
  unsigned uses;       ///< BaselineUse flags
  std::shared_ptr<Policy> (*make)(const MarketSteps& market, const BatteryParameters& battery);

  [[nodiscard]] bool is_for(BaselineUse use) const { return (uses & use) != 0; }
};

/// In the order of tables; foresight is last.
std::span<const Baseline> baselines();
std::vector<std::string> baseline_names(BaselineUse use);
/// Baselines shown next to the exported policy, the most important first.
std::vector<std::string> rival_names();

/// "rbc:11:179" is not a row: it gives the thresholds, EUR/MWh.
inline constexpr std::string_view kGivenRule = "rbc:";
std::shared_ptr<Policy> given_rule(const std::string& name);

/// Null if there is no such row.
const Baseline* find_baseline(std::string_view name);
/// By row name, or a given rule; null for unknown names. Fits on the training days of `market`,
/// whose delay may differ from the traded market's. Throws UserError.
std::shared_ptr<Policy> make_baseline(const std::string& name, const MarketSteps& market,
                                      const BatteryParameters& battery);

}  // namespace bess
