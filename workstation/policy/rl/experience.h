// Experience sources [SPEC 4]:
//   counterfactual  prices ignore the battery, so an observed price transition is valid for
//                   EVERY SoC and action: each sample draws a training step, a SoC and an action.
//   replay          the paper's: epsilon-greedy days from a uniform SoC into a ring of the last 1e6
//                   transitions (train.h).
#pragma once

#include <optional>
#include <vector>

#include "shared/battery_model.h"
#include "workstation/base/random.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/policy/rl/teacher.h"
#include "workstation/policy/rl/transition.h"

namespace bess {

enum class Horizon {
  kContinuing,  ///< truncation at midnight: bootstraps from the next training day
  kDay,         ///< terminal at local midnight (the paper's episodes)
};

/// With a program, rewards are r' of teacher.h, centred; otherwise they are money.
struct RewardShaping {
  BasePrograms program{};
  int threads = 1;  ///< for its plans
};

/// Standard deviations of a random shift of the calendar inputs, equal for a state and its
/// successor. Only twenty days share a (month, quarter-hour): without it the network memorises
/// their prices.
struct ContextJitter {
  double quarter_hours = 4;
  double classes = 0.5;
};

/// Training steps with their successors, ready to become transitions.
class TrainingMarket {
 public:
  /// Throws UserError if `market` has no training days.
  TrainingMarket(const MarketSteps& market, const PriceMap& price_map,
                 const BatteryParameters& battery, Horizon horizon, const RewardShaping& shaping,
                 const ContextClasses& context = {});

  /// Transition of `action` at `soc_frac` in step `index`; returns the SoC after it.
  double make_transition(std::size_t index, double soc_frac, Action action, Transition& out) const;
  [[nodiscard]] double draw_soc(Random& random) const {
    return battery_.soc_min_frac +
           random.uniform() * (battery_.soc_max_frac - battery_.soc_min_frac);
  }

  [[nodiscard]] std::size_t step_count() const { return steps_.size(); }
  [[nodiscard]] const NetworkContext& context(std::size_t index) const {
    return steps_[index].context;
  }
  /// Residual only: discounted sums of r' of the program on the training days from the middle of
  /// the SoC window, one per step, in learned units. The support must cover them.
  [[nodiscard]] std::vector<float> residual_returns(double discount) const;
  /// First step and number of steps of each training day.
  struct Day {
    std::size_t first;
    std::size_t count;
  };
  [[nodiscard]] const std::vector<Day>& days() const { return days_; }

 private:
  struct Step {
    NetworkContext context;
    NetworkContext next;
    float import_eur_per_mwh, export_eur_per_mwh;  ///< paid price with trading costs
    bool terminal;
    std::int8_t quarter_hour;             ///< local
    std::uint32_t row = 0, next_row = 0;  ///< rows of program_
    bool begins_anew = false;             ///< the successor starts a new plan of the program
    float centre = 0;                     ///< of r', if specific to the step
    bool follows_last = false;            ///< the step is the successor of the previous one
  };
  /// Network context of a row at this SoC.
  [[nodiscard]] NetworkContext seen(NetworkContext context, std::uint32_t row,
                                    double soc_frac) const;
  void shape_by_program(const Step& step, double soc_frac, double next_soc_frac,
                        Transition& out) const;
  /// Calls visit(step, transition) for every step that the program trades, the SoC carried over.
  template <typename Visit>
  void trade_by_program(Visit visit) const;
  void centre_residuals();
  [[nodiscard]] double middle_soc_frac() const {
    return 0.5 * (battery_.soc_min_frac + battery_.soc_max_frac);
  }

  BatteryParameters battery_;
  float reward_centre_ = 0;  ///< of r', scaled
  std::optional<ProgramRows> program_;
  PriceMap price_map_;
  std::vector<Step> steps_;
  std::vector<Day> days_;
};

/// Observed prices of all training decisions, for fitting the price map.
std::vector<double> observed_training_prices(const MarketSteps& market);

/// Draws `count` counterfactual transitions. All three actions use each price transition and SoC in
/// turn: they share its noise, which does not mask their differences.
void draw_counterfactual(const TrainingMarket& market, std::size_t count,
                         const ContextJitter& jitter, Random& random, std::vector<Transition>& out);

}  // namespace bess
