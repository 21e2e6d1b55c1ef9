// The stochastic program with an outlook: what is usual today is not what was usual in the mean of
// the days fitted on, for today's day-ahead prices have been published. It plans each day anew on
//
//   usual(t, L) = c0 + c1 D(t) + c2 h(quarter-hour of t) + c3 L
//
//   D(t)  day-ahead price of the quarter-hour of t; where it is not published yet, d plus what the
//         last day that is known lies above d, times how much of that lasts a day
//   h, d  mean paid and mean day-ahead price by local quarter-hour of the days fitted on, smoothed
//   L     trailing price level of the moment
//   c     least squares on the days fitted on, L being that of the day's start: what it says of
//         the hours that are planned, not of the one at hand
//
// The deviation of the newest price from it is the chain of deviation_chain.h. A plan reaches from
// now to the end of tomorrow, by UTC instants, so that a day may have 92 or 100 quarter-hours;
// behind it follow usual days for ever. It holds until midnight or until more is published. Values
// are found for a few levels and interpolated, so that the level of the moment counts, and later
// hours' levels are never seen: a plan made with those would be look-ahead.
// Without day-ahead prices D is d and the program is the one by hour and level.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "workstation/data/env/policy.h"
#include "workstation/policy/planners/deviation_chain.h"
#include "workstation/policy/planners/soc_grid.h"
#include "workstation/policy/planners/stochastic_program.h"

namespace bess {

struct OutlookOptions {
  int levels = 5;              ///< price levels that values are found for
  double gamma = 0.9995;       ///< discount a step
  double hour_smoothing = 4;   ///< of h and d, quarter-hours
  double bin_smoothing = 0.5;  ///< of the chain's counts, bins
};

class OutlookProgram {
 public:
  static constexpr int kSocPoints = 121;
  using ByQuarterHour = std::array<double, 96>;

  /// What usual() is made of.
  struct Coefficients {
    double constant = 0, day_ahead = 0, hour = 0, level = 0;
    double lasting = 0;  ///< share of a day-ahead day's height over d that the next day has
  };

  /// What was published when the plan was made, and the day that it is for.
  struct Plan {
    std::int64_t from_utc_s = 0, until_utc_s = 0;      ///< decisions that it serves
    std::int64_t end_utc_s = 0;                        ///< midnight after tomorrow
    std::int64_t first_quarter_hour_utc_s = 0;         ///< of `day_ahead`
    std::vector<double> day_ahead{};                   ///< D by quarter-hour
    std::map<int, std::vector<float>> continuation{};  ///< by level: [step][bin][SoC point], EUR

    [[nodiscard]] bool serves(const MarketStep& step) const {
      return step.utc_s >= from_utc_s && step.utc_s < until_utc_s;
    }
  };

  /// Fits on `days` of `market`; throws UserError when there are none, or when none of their steps
  /// has a day-ahead price.
  OutlookProgram(const MarketSteps& market, const std::vector<MarketDay>& days,
                 const BatteryParameters& battery, const OutlookOptions& options = {});

  /// What is known at this step, without any values yet.
  [[nodiscard]] Plan plan_of(const MarketStep& step) const;
  /// What each action is worth, EUR until ever, up to a constant: [discharge, idle, charge]. Finds
  /// the values of the plan that it needs and keeps them there. The plan must serve the step.
  [[nodiscard]] std::array<double, kActionCount> action_values(const MarketStep& step,
                                                               double soc_frac, Plan& plan) const;
  /// Writes what the rest is worth by SoC after this step, EUR, kSocPoints values; returns the
  /// price that the step is expected to be paid: action_values() are made of the two. The plan must
  /// serve the step.
  double continuation(const MarketStep& step, Plan& plan, float* value_eur) const;
  /// action_values() that keeps what it sees at this step for whoever asks again, of some hundred
  /// days: validations and policies compared trade the same ones. A step that is not kept is seen
  /// in `plan`, which need not serve it. Threads may share the program.
  [[nodiscard]] std::array<double, kActionCount> kept_action_values(const MarketStep& step,
                                                                    double soc_frac,
                                                                    Plan& plan) const;
  /// Sees all steps of these days beforehand, on so many threads, and keeps them.
  void prepare(const MarketSteps& market, const std::vector<MarketDay>& days, int threads) const;
  [[nodiscard]] const Coefficients& coefficients() const { return coefficients_; }
  [[nodiscard]] const ByQuarterHour& hour() const { return hour_; }
  [[nodiscard]] const ByQuarterHour& day_ahead_mean() const { return day_ahead_mean_; }
  [[nodiscard]] const DeviationChain& chain() const { return chain_; }
  [[nodiscard]] const BatteryParameters& battery() const { return battery_; }
  [[nodiscard]] double gamma() const { return options_.gamma; }
  /// Of the newest price at a decision, as it mostly was on the days fitted on.
  [[nodiscard]] int row_age_min() const { return row_age_min_; }

  /// What was fitted, without what follows from it: reading solves again, to the same bits.
  void save(BinaryWriter& out) const;
  explicit OutlookProgram(BinaryReader& in);

 private:
  /// Where a step lies among the values that are known: two levels, of each two bins.
  struct Sight {
    std::array<const float*, 2> ahead;  ///< by level, at the lower bin; null: without weight
    DeviationChain::Between bins, levels;
    double price_eur_per_mwh;  ///< expected
    double full_power_w;       ///< of the step
  };
  struct Kept;
  [[nodiscard]] Sight sight_of(const MarketStep& step, Plan& plan) const;
  [[nodiscard]] std::array<double, kActionCount> worth(const Sight& sees, double soc_frac) const;
  [[nodiscard]] double usual(double day_ahead, int quarter_hour, double level) const;
  /// D at a step's own row or pay: what is published, or what stands for it.
  [[nodiscard]] double known_or_usual(const MarketStep& step, std::int64_t utc_s) const;
  [[nodiscard]] double usual_at(const Plan& plan, std::int64_t utc_s, double level) const;
  [[nodiscard]] double usual_paid(const Plan& plan, std::int64_t step_utc_s, double level) const;
  void fit_means(const MarketSteps& market, const std::vector<MarketDay>& days);
  void fit_lasting(const MarketSteps& market, const std::vector<MarketDay>& days);
  void fit_coefficients(const MarketSteps& market, const std::vector<MarketDay>& days);
  void fit_levels(const MarketSteps& market, const std::vector<MarketDay>& days);
  void fit_chain(const MarketSteps& market, const std::vector<MarketDay>& days);
  void solve_usual_days();
  [[nodiscard]] double height_before(const MarketStep& step) const;
  const std::vector<float>& continuation_of(int level, Plan& plan) const;
  [[nodiscard]] DeviationChain::Between between_levels(double level) const;

  BatteryParameters battery_;
  OutlookOptions options_;
  SocGrid grid_;
  ByQuarterHour hour_{}, day_ahead_mean_{};  ///< h, d
  Coefficients coefficients_;
  int row_age_min_ = 1;
  std::vector<double> levels_;  ///< that values are known for, ascending
  DeviationChain chain_;
  StorageRecursion recursion_;
  std::vector<std::vector<float>> usual_days_;  ///< by level: [bin][SoC point] at midnight, EUR
  std::shared_ptr<Kept> kept_;
};

class OutlookPolicy final : public Policy {
 public:
  OutlookPolicy(const MarketSteps& market, const std::vector<MarketDay>& days,
                const BatteryParameters& battery, const OutlookOptions& options = {})
      : program_(std::make_shared<const OutlookProgram>(market, days, battery, options)) {}
  explicit OutlookPolicy(std::shared_ptr<const OutlookProgram> program)
      : program_(std::move(program)) {}
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t, double soc_frac) const override;
  /// The program's action values, of the newest plan or a new one.
  [[nodiscard]] std::array<double, kActionCount> action_values(const MarketStep& step,
                                                               double soc_frac) const;
  [[nodiscard]] std::string description() const override;

 private:
  std::shared_ptr<const OutlookProgram> program_;
  mutable std::mutex mutex_;           ///< of the plan
  mutable OutlookProgram::Plan plan_;  ///< the newest; a function of the step alone
};

}  // namespace bess
