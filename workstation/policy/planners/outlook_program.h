// Stochastic program with an outlook: the usual price follows today's published day-ahead prices
// instead of the mean of the fitted days. It replans each day on
//
//   usual(t, L) = c0 + c1 D(t) + c2 h(quarter-hour of t) + c3 L
//
//   D(t)  day-ahead price of the quarter-hour of t; if not published yet, d plus the height of the
//         last known day over d, times the share of it that persists for a day
//   h, d  mean paid and mean day-ahead price by local quarter-hour of the fitted days, smoothed
//   L     present trailing price level
//   c     least squares on the fitted days with the L of the day's start, because the planned hours
//         are later than the present one
//
// The deviation of the newest price from it follows DeviationChain. A plan covers now to the end
// of tomorrow, by UTC instants, so that a day may have 92 or 100 quarter-hours; usual days follow
// without end. It is valid until midnight or a further publication. Values are computed for a few
// levels and interpolated, so that the present level is used; levels of later hours would be
// look-ahead. Without day-ahead prices D is d, and the program equals the one by hour and level.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "shared/outlook/outlook_model.h"
#include "workstation/data/env/policy.h"
#include "workstation/policy/planners/soc_grid.h"
#include "workstation/policy/planners/stochastic_program.h"

namespace bess {

class OutlookProgram {
 public:
  static constexpr int kSocPoints = 121;
  using ByQuarterHour = std::array<double, 96>;

  /// Coefficients of usual().
  struct Coefficients {
    double constant = 0, day_ahead = 0, hour = 0, level = 0;
    double lasting = 0;  ///< share of a day's height over d that persists for a day
  };

  /// Published prices at the time of planning, and the day of the plan.
  struct Plan {
    std::int64_t from_utc_s = 0, until_utc_s = 0;      ///< validity for decisions
    std::int64_t end_utc_s = 0;                        ///< midnight after tomorrow
    std::int64_t first_quarter_hour_utc_s = 0;         ///< start of `day_ahead`
    std::vector<double> day_ahead{};                   ///< D by quarter-hour
    std::map<int, std::vector<float>> continuation{};  ///< by level: [step][bin][SoC point], EUR

    [[nodiscard]] bool serves(const MarketStep& step) const {
      return step.utc_s >= from_utc_s && step.utc_s < until_utc_s;
    }
  };

  /// Fits on `days` of `market`; throws UserError without days, or if no step has a day-ahead
  /// price.
  OutlookProgram(const MarketSteps& market, const std::vector<MarketDay>& days,
                 const BatteryParameters& battery);

  /// Known prices at this step, without values.
  [[nodiscard]] Plan plan_of(const MarketStep& step) const;
  /// Value of each action, EUR over an infinite horizon, up to a constant: [discharge, idle,
  /// charge]. Computes and stores the plan's values as needed. The plan must be valid for the step.
  [[nodiscard]] std::array<double, kActionCount> action_values(const MarketStep& step,
                                                               double soc_frac, Plan& plan) const;
  /// Writes the continuation value by SoC after this step, EUR, kSocPoints values; returns the
  /// expected price of the step. action_values() consists of the two. The plan must be valid for
  /// the step.
  double continuation(const MarketStep& step, Plan& plan, float* value_eur) const;
  /// action_values() with a cache of some hundred days: validations and compared policies trade the
  /// same ones. A step that is not cached uses `plan`, which need not be valid for it. Thread-safe,
  /// also for a shared `plan`.
  [[nodiscard]] std::array<double, kActionCount> kept_action_values(const MarketStep& step,
                                                                    double soc_frac,
                                                                    Plan& plan) const;
  /// Fills the cache for all steps of these days.
  void prepare(const MarketSteps& market, const std::vector<MarketDay>& days, int threads) const;
  [[nodiscard]] const Coefficients& coefficients() const { return coefficients_; }
  [[nodiscard]] const ByQuarterHour& hour() const { return hour_; }
  [[nodiscard]] const ByQuarterHour& day_ahead_mean() const { return day_ahead_mean_; }
  [[nodiscard]] const DeviationChain& chain() const { return chain_; }
  [[nodiscard]] const BatteryParameters& battery() const { return battery_; }
  [[nodiscard]] double gamma() const { return gamma_; }
  /// Most frequent age of the newest price at a decision on the fitted days.
  [[nodiscard]] int row_age_min() const { return row_age_min_; }

  /// Fitted values only: reading recomputes the rest, bit-identical.
  void save(BinaryWriter& out) const;
  explicit OutlookProgram(BinaryReader& in);

 private:
  /// Position of a step among the computed values: two levels with two bins each.
  struct GridPosition {
    std::array<const float*, 2> ahead;  ///< by level, at the lower bin; null: zero weight
    DeviationChain::BinPosition bins, levels;
    double price_eur_per_mwh;  ///< expected
    double full_power_w;       ///< of the step
  };
  struct ValueCache;
  [[nodiscard]] GridPosition grid_position_of(const MarketStep& step, Plan& plan) const;
  [[nodiscard]] std::array<double, kActionCount> worth(const GridPosition& position,
                                                       double soc_frac) const;
  [[nodiscard]] double usual(double day_ahead, int quarter_hour, double level) const;
  /// D at a step's row or payment: published price, or its substitute.
  [[nodiscard]] double known_or_usual(const MarketStep& step, std::int64_t utc_s) const;
  [[nodiscard]] double usual_at(const Plan& plan, std::int64_t utc_s, double level) const;
  [[nodiscard]] double usual_paid(const Plan& plan, std::int64_t step_utc_s, double level) const;
  void fit_means(const MarketSteps& market, const std::vector<MarketDay>& days);
  void fit_lasting(const MarketSteps& market, const std::vector<MarketDay>& days);
  void fit_coefficients(const MarketSteps& market, const std::vector<MarketDay>& days);
  void fit_chain(const MarketSteps& market, const std::vector<MarketDay>& days);
  void solve_usual_days();
  [[nodiscard]] double height_before(const MarketStep& step) const;
  const std::vector<float>& continuation_of(int level, Plan& plan) const;

  BatteryParameters battery_;
  double gamma_ = kProgramGamma;
  SocGrid grid_;
  ByQuarterHour hour_{}, day_ahead_mean_{};  ///< h, d
  Coefficients coefficients_;
  int row_age_min_ = 1;
  std::vector<double> levels_;  ///< price levels with values, ascending
  DeviationChain chain_;
  StorageRecursion recursion_;
  std::vector<std::vector<float>> usual_days_;  ///< by level: [bin][SoC point] at midnight, EUR
  std::shared_ptr<ValueCache> cache_;
};

/// Integer form of the program, used by workstation and edge (shared/outlook): half as many bins,
/// each two adjacent bins of the chain. Throws UserError for values outside the integer ranges.
OutlookModel outlook_integers(const OutlookProgram& program);

class OutlookPolicy final : public Policy {
 public:
  OutlookPolicy(const MarketSteps& market, const std::vector<MarketDay>& days,
                const BatteryParameters& battery)
      : program_(std::make_shared<const OutlookProgram>(market, days, battery)) {}
  explicit OutlookPolicy(std::shared_ptr<const OutlookProgram> program)
      : program_(std::move(program)) {}
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t, double soc_frac) const override;
  /// The program's action values from the latest plan or a new one.
  [[nodiscard]] std::array<double, kActionCount> action_values(const MarketStep& step,
                                                               double soc_frac) const;
  [[nodiscard]] std::string description() const override;

 private:
  std::shared_ptr<const OutlookProgram> program_;
  /// Latest plan, a function of the step only; protected by the program's cache.
  mutable OutlookProgram::Plan plan_;
};

}  // namespace bess
