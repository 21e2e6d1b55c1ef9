// Training of the teacher: one loop of draw, learn, blend the target, validate. Differences from
// the paper: Adam; by default the network adds to the stochastic program, from counterfactual
// experience and over a continuing horizon (the `paper` preset trains a network only, from a replay
// of daily episodes). Validation days, SoC carried over, select the kept weights (kept_point).
#pragma once

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
