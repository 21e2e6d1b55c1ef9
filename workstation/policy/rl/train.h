// Training of the teacher: one loop of draw, learn, blend the target, validate. Differences from
// the paper: Adam; by default the network adds to the stochastic program, from counterfactual
// experience and over a continuing horizon (the `paper` preset trains a network only, from a replay
// of daily episodes). Validation days, SoC carried over, select the kept weights (kept_point).
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/battery_model.h"
#include "workstation/base/binary_file.h"
#include "workstation/base/random.h"
#include "workstation/data/env/context_fit.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/policy/rl/teacher.h"

namespace bess {

// Experience sources [SPEC 4]:
//   counterfactual  prices ignore the battery, so an observed price transition is valid for
//                   EVERY SoC and action: each sample draws a training step, a SoC and an action.
//   replay          the paper's: epsilon-greedy days from a uniform SoC into a ring of the last 1e6
//                   transitions (Replay).

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

// Selection of the step that becomes the teacher. Network only: the highest profit on the
// validation days. A residual starts, at step 0, as the stochastic program, and the best of a dozen
// checks on twenty days is mostly the luckiest: a later step is kept only if its gain over the
// program is shown (shared/manual/notebook/2026-11-25_checkpoint_selection.md).
//
// A gain is shown if, with paired days, it exceeds its interval (../data/env/day_errors.h). Each of
// n checks may be wrong by chance in one case of 20 n, so that all together are in at most one of
// 20 [Bonferroni; Dunn 1961].

/// Result on the validation days.
struct CurvePoint {
  long step;
  double loss;
  double validation_eur_per_day_per_mwh;
  double edge_mass_frac;  ///< target probability on the end atoms; above 1 %: widen the support
  /// Residual: lower end of the interval of its gain over step 0. 0 at step 0 and without a
  /// residual.
  double gain_at_least_eur_per_day_per_mwh = 0;
};

/// Lower end of the interval of the gain of `earned` over a program that earned `program_eur` on
/// the same days, at one of `looks` checks. For a single day it is far below any gain.
double gain_at_least_eur_per_day_per_mwh(const Evaluation& earned,
                                         std::span<const double> program_eur, long looks);

/// The point whose weights are the teacher; the first of equals. `curve` must not be empty.
const CurvePoint& kept_point(const std::vector<CurvePoint>& curve);

// The paper's experience: epsilon-greedy days from a uniform initial SoC, into a ring of
// transitions. Many days act in parallel with the present weights, because one forward pass over 32
// columns costs little more than one over a single column.

class Replay {
 public:
  Replay(const TrainingMarket& market, std::size_t capacity)
      : market_(market), capacity_(capacity) {}

  /// Plays `days` days drawn with replacement, exploring with probability epsilon.
  void play(const Teacher& teacher, std::size_t days, double epsilon, Random& random);

  /// A minibatch of `count` transitions drawn with replacement.
  void draw(std::size_t count, Random& random, MiniBatch& batch);

  /// In the order of the ring's slots.
  [[nodiscard]] const std::vector<Transition>& transitions() const { return ring_; }

  void save(BinaryWriter& out) const;
  /// Throws UserError if the ring in the file has another size.
  void restore(BinaryReader& in);

 private:
  void store(const Transition& transition);

  const TrainingMarket& market_;
  std::size_t capacity_;
  std::size_t next_ = 0;  ///< slot that the next transition overwrites once the ring is full
  std::vector<Transition> ring_;
  std::vector<Transition> drawn_;  ///< of the last minibatch
};

enum class Source { kCounterfactual, kReplay };

struct TrainOptions {
  Method method = Method::kC51;
  Source source = Source::kCounterfactual;
  Horizon horizon = Horizon::kContinuing;
  long steps = 1'500;           ///< gradient steps
  double mean_weight = 30;      ///< C51: of the mean's squared error, relative to the cross-entropy
  long batch_size = 4'096;      ///< transitions per step
  double learning_rate = 1e-3;  ///< of Adam; cosine decay to `learning_rate_end`
  double learning_rate_end = 5e-5;
  double gamma = 0.999;
  bool residual = true;          ///< a network adds to the stochastic program (teacher.h)
  double residual_gamma = 0.98;  ///< its discount per step, instead of gamma
  double tau = 0.05;             ///< target <- tau * online + (1 - tau) * target, each step
  int atoms = 51;
  ContextKind context = ContextKind::kLevel;
  ContextJitter jitter;  ///< counterfactual source only
  double value_min_eur_per_h = -1e5;
  double value_max_eur_per_h = 1e5;
  double average_decay = 0.998;  ///< of the averaged, validated weights; 0 = no averaging
  long validate_every = 250;     ///< gradient steps
  std::uint64_t seed = 1;
  int threads = 2;
};

struct TrainResult {
  Teacher teacher;  ///< selected by validation
  std::vector<CurvePoint> curve;
  double best_validation_eur_per_day_per_mwh;  ///< of the selected step
  long best_step;
  double seconds;
};

/// Resumption of an interrupted run. The checkpoint file is replaced atomically at every validation
/// and interruption; resuming gives bit-identical weights.
struct CheckpointOptions {
  std::filesystem::path path;  ///< empty: no checkpoint
  bool resume = false;         ///< continue from `path`, which must exist
  std::string identity;        ///< configuration and prices; must equal the checkpoint's
};

/// The checkpoint is damaged, or of another run.
struct CheckpointUnusable : UserError {
  using UserError::UserError;
};

/// Trains on the training days of `market` and selects on its validation days. `interrupted` is
/// called before every gradient step and every day of a validation: true ends training with the
/// best result so far; resuming starts with an interrupted validation. Throws UserError for missing
/// days, CheckpointUnusable; option ranges are checked where they are read
/// (runs/chain/run_config.cpp).
TrainResult train_teacher(const MarketSteps& market, const BatteryParameters& battery,
                          const TrainOptions& options, const std::function<bool()>& interrupted,
                          const CheckpointOptions& checkpoint = {});

}  // namespace bess
