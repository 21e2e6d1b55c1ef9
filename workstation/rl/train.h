// Training of the teacher: one readable loop of draw, learn, blend the target, look at the
// validation days. Differences from the paper: Adam; by default the network adds to the stochastic
// program, from counterfactual experience and over a continuing horizon (the `paper` preset learns
// alone, from a replay of daily episodes). Validation days, charge carried over, choose the weights
// that are kept (kept_step.h).
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "workstation/env/context_fit.h"
#include "workstation/env/evaluate.h"
#include "workstation/rl/experience.h"
#include "workstation/rl/kept_step.h"
#include "workstation/rl/teacher.h"

namespace bess {

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
