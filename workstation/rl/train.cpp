#include "workstation/rl/train.h"

#include <algorithm>
#include <chrono>
#include <numbers>

#include "workstation/env/tabular.h"
#include "workstation/io/progress.h"
#include "workstation/io/user_error.h"
#include "workstation/rl/learner.h"
#include "workstation/rl/replay.h"

namespace bess {
namespace {

/// Named purposes of the run's random draws.
enum Seed : std::uint64_t { kSeedWeights = 1, kSeedExperience = 2, kSeedMinibatch = 3 };
/// Days that act in lock-step with the same weights; one gradient step follows for each of them.
constexpr long kLockstepDays = 32;

/// Hands out minibatches from the configured source.
class Experience {
 public:
  Experience(const TrainingMarket& market, const TrainOptions& options)
      : market_(market),
        options_(options),
        replay_(market, static_cast<std::size_t>(options.replay_capacity)),
        experience_random_(derive_seed(options.seed, kSeedExperience)),
        minibatch_random_(derive_seed(options.seed, kSeedMinibatch)) {}

  const MiniBatch& next(long step, const Teacher& acting) {
    const auto count = static_cast<std::size_t>(options_.batch_size);
    if (options_.source == Source::kCounterfactual) {
      draw_counterfactual(market_, count, options_.jitter, minibatch_random_, drawn_);
      pointers_.clear();
      for (const Transition& transition : drawn_) pointers_.push_back(&transition);
    } else {
      if (step % kLockstepDays == 0) {
        replay_.play(acting, kLockstepDays, epsilon(step), experience_random_);
      }
      replay_.draw(count, minibatch_random_, pointers_);
    }
    fill_minibatch(pointers_, batch_);
    return batch_;
  }

 private:
  [[nodiscard]] double epsilon(long step) const {
    const double progress =
        std::min(1.0, 2.0 * static_cast<double>(step) / static_cast<double>(options_.steps));
    return options_.epsilon_start + progress * (options_.epsilon_end - options_.epsilon_start);
  }

  const TrainingMarket& market_;
  const TrainOptions& options_;
  Replay replay_;
  Random experience_random_;
  Random minibatch_random_;
  std::vector<Transition> drawn_;
  std::vector<const Transition*> pointers_;
  MiniBatch batch_;
};

/// Mean reward an hour of the tabular baseline on the training days, for the paper's battery size.
double tabular_reward_eur_per_h(const MarketSteps& market, const std::vector<MarketDay>& training,
                                const BatteryParameters& battery) {
  TabularPolicy tabular(market, training, battery);
  EvaluationOptions options;
  options.battery = battery;
  options.carry_soc = true;
  const Evaluation evaluation = evaluate(market, training, tabular, options);
  const double capacity_hours = battery.capacity_wh / battery.power_w_max;
  return evaluation.profit_eur_per_day_per_mwh() * capacity_hours * double{kPaperPowerMw} / 24;
}

/// Shaped rewards r + gamma Phi(s') - Phi(s) drift by -(1 - gamma) mean Phi: that goes with the
/// centre, so that values lie around zero.
RewardShaping fit_shaping(const MarketSteps& market, const BatteryParameters& battery,
                          const TrainOptions& options) {
  RewardShaping shaping{0, options.gamma, fit_potential(options.potential, market, battery)};
  if (!options.centre_rewards || options.horizon != Horizon::kContinuing) return shaping;
  const double eur_per_h_of_eur = double{kPaperPowerMw} * 1e6 / battery.power_w_max / kHoursPerStep;
  shaping.reward_centre_eur_per_h =
      tabular_reward_eur_per_h(market, market.days_of(Split::kTrain), battery) -
      (1 - options.gamma) * mean_of(shaping.potential, market) * eur_per_h_of_eur;
  return shaping;
}

double cosine_rate(const TrainOptions& options, long step) {
  const double progress = static_cast<double>(step) / static_cast<double>(options.steps);
  const double blend = 0.5 * (1 + std::cos(std::numbers::pi * progress));
  return options.learning_rate_end + blend * (options.learning_rate - options.learning_rate_end);
}

}  // namespace

TrainResult train_teacher(const MarketSteps& market, const BatteryParameters& battery,
                          const TrainOptions& options, const std::atomic<bool>& interrupted) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<MarketDay> validation = market.days_of(Split::kValidation);
  if (validation.empty())
    fail("no validation days (local days 21 to 25) in these prices; add some");
  if (market.days_of(Split::kTrain).empty()) {
    fail("no training days (local days 1 to 20) in these prices; add some");
  }
  const PriceMap price_map = PriceMap::fit(observed_training_prices(market));
  const TrainingMarket training(market, price_map, battery, options.horizon,
                                fit_shaping(market, battery, options));
  const Support support{static_cast<float>(options.value_min_eur_per_h) * kRewardScale,
                        static_cast<float>(options.value_max_eur_per_h) * kRewardScale,
                        options.atoms};
  Learner learner(options.method, support, options.gamma, derive_seed(options.seed, kSeedWeights),
                  options.threads, options.mean_weight);
  Experience experience(training, options);
  Teacher current{options.method, support, learner.shape(), price_map, learner.online(), ""};
  TrainResult result{current, {}, -1e300, 0, 0};
  Parameters average = learner.online();
  Progress progress(fmt::format("train {}", method_name(options.method)), "steps",
                    static_cast<double>(options.steps));
  Learner::StepResult sums{0, 0};
  long summed = 0;
  for (long step = 0; step < options.steps && !interrupted; ++step) {
    if (options.source == Source::kReplay) current.parameters = learner.online();
    const MiniBatch& batch = experience.next(step, current);
    const auto learned = learner.step(batch, cosine_rate(options, step), options.tau);
    average += static_cast<float>(1 - options.average_decay) * (learner.online() - average);
    sums.loss += learned.loss;
    sums.edge_mass_frac += learned.edge_mass_frac;
    ++summed;
    progress.update(
        static_cast<double>(step + 1),
        fmt::format(
            "loss {:.4f}  validation {:.1f} EUR/day/MWh", learned.loss,
            result.curve.empty() ? 0.0 : result.curve.back().validation_eur_per_day_per_mwh));
    if ((step + 1) % options.validate_every != 0 && step + 1 != options.steps) continue;
    current.parameters = average;
    TeacherPolicy policy(current);
    EvaluationOptions evaluation;
    evaluation.battery = battery;
    const double profit =
        evaluate(market, validation, policy, evaluation).profit_eur_per_day_per_mwh();
    const auto n = static_cast<double>(summed);
    result.curve.push_back({step + 1, sums.loss / n, profit, sums.edge_mass_frac / n});
    sums = {0, 0};
    summed = 0;
    if (profit > result.best_validation_eur_per_day_per_mwh) {
      result.best_validation_eur_per_day_per_mwh = profit;
      result.best_step = step + 1;
      result.teacher.parameters = average;
    }
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace bess
