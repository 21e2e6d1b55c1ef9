// Training of the teacher: one readable loop of draw, learn, blend the target, look at the
// validation days. Differences from the paper: Adam; by default the network adds to the stochastic
// program, from counterfactual experience and over a continuing horizon (the `paper` preset learns
// alone, from a replay of daily episodes). Validation days, charge carried over, choose the weights
// that are kept (KeptStep).
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "workstation/base/binary_file.h"
#include "workstation/data/env/context_fit.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/policy/rl/experience.h"
#include "workstation/policy/rl/teacher.h"

namespace bess {

// Which step of a training becomes the teacher. A network alone: the one that earned most on the
// validation days. A residual begins, at step 0, as the stochastic program, and the best of a dozen
// looks at twenty days is mostly the luckiest: a later step is kept only where its gain over the
// program is shown (workstation/README.md, "A seed never costs").
//
// Shown is a gain, the days in pairs, beyond its interval (../data/env/day_errors.h: the wider of
// the plain one and the one by month, by Student's t). Each of n looks may be wrong by chance in
// one case of 20 n, so that all together are in at most one of 20 [Bonferroni; Dunn 1961].

/// A look at the validation days.
struct CurvePoint {
  long step;
  double loss;
  double validation_eur_per_day_per_mwh;
  double edge_mass_frac;  ///< target mass on the two end atoms; above 1 % the support is too narrow
  /// Of a residual: lower end of the interval of its gain over step 0. 0 at step 0 and of a network
  /// alone.
  double gain_at_least_eur_per_day_per_mwh = 0;
};

/// Lower end of the interval of the gain of `earned` over a program that earned `program_eur` on
/// the same days, at one of `looks` looks. Of a single day that is far below any gain.
double gain_at_least_eur_per_day_per_mwh(const Evaluation& earned,
                                         std::span<const double> program_eur, long looks);

/// The point whose weights are the teacher; of equals the first. `curve` is not empty.
const CurvePoint& kept_point(const std::vector<CurvePoint>& curve);

// The paper's experience: epsilon-greedy days from a uniform initial SoC, into a ring of
// transitions. Days are acted in lock-step, many at once with the weights of that moment, because
// one forward pass over 32 columns costs little more than one over a single column.

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
  /// Throws UserError when the ring in the file does not fit this one.
  void restore(BinaryReader& in);

 private:
  void store(const Transition& transition);

  const TrainingMarket& market_;
  std::size_t capacity_;
  std::size_t next_ = 0;  ///< slot that the next transition overwrites once the ring is full
  std::vector<Transition> ring_;
  std::vector<std::uint32_t> drawn_;  ///< slots of the last minibatch
};

enum class Source { kCounterfactual, kReplay };

struct TrainOptions {
  Method method = Method::kC51;
  Source source = Source::kCounterfactual;
  Horizon horizon = Horizon::kContinuing;
  long steps = 1'500;           ///< gradient steps
  double mean_weight = 30;      ///< C51: of the squared error of the mean beside the cross-entropy
  long batch_size = 4'096;      ///< transitions a step
  double learning_rate = 1e-3;  ///< of Adam, falling to `learning_rate_end` along a cosine
  double learning_rate_end = 5e-5;
  double gamma = 0.999;
  bool residual = true;          ///< a network adds to the stochastic program (program_residual.h)
  double residual_gamma = 0.98;  ///< discount a step of what it adds, in place of gamma
  double tau = 0.05;             ///< target <- tau * online + (1 - tau) * target, each step
  int atoms = 51;
  ContextKind context = ContextKind::kLevel;
  ContextJitter jitter;  ///< counterfactual source only
  double value_min_eur_per_h = -1e5;
  double value_max_eur_per_h = 1e5;
  double average_decay = 0.998;  ///< of the averaged weights that are validated and kept; 0 = none
  long validate_every = 250;     ///< gradient steps
  std::uint64_t seed = 1;
  int threads = 2;
};

struct TrainResult {
  Teacher teacher;  ///< the one that validation kept
  std::vector<CurvePoint> curve;
  double best_validation_eur_per_day_per_mwh;  ///< of the step that was kept
  long best_step;
  double seconds;
};

/// Where a run can be taken up again after an interruption. A checkpoint is written beside and
/// renamed at every validation and at an interruption; continuing from one gives the same weights,
/// to the bit, as never having stopped.
struct CheckpointOptions {
  std::filesystem::path path;  ///< empty: none is kept
  bool resume = false;         ///< continue from `path`; an error when it is not there
  std::string identity;        ///< configuration and prices: a checkpoint of others is refused
};

/// Trains on the training days of `market` and selects on its validation days. `interrupted` is
/// asked before every gradient step and every day of a validation: true ends it early with what is
/// best so far; a validation that was broken off is the first thing when it is resumed. Throws
/// UserError for missing days; ranges of the options are checked where they are read
/// (cli/run_config.cpp).
TrainResult train_teacher(const MarketSteps& market, const BatteryParameters& battery,
                          const TrainOptions& options, const std::function<bool()>& interrupted,
                          const CheckpointOptions& checkpoint = {});
/// The same, ended by a flag that a signal raises.
TrainResult train_teacher(const MarketSteps& market, const BatteryParameters& battery,
                          const TrainOptions& options, const std::atomic<bool>& interrupted,
                          const CheckpointOptions& checkpoint = {});

}  // namespace bess
