#include "workstation/policy/rl/train.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/base/progress.h"
#include "workstation/policy/planners/foresight.h"
#include "workstation/policy/rl/learner.h"

namespace bess {

namespace {

constexpr double kFarBelow = -1e300;

}  // namespace

double gain_at_least_eur_per_day_per_mwh(const Evaluation& earned,
                                         std::span<const double> program_eur, long looks) {
  Evaluation program = earned;
  for (std::size_t d = 0; d < program.days.size(); ++d) {
    program.days[d].profit_eur = program_eur[d];
  }
  const PairedDifference gain = paired_difference(earned, program);
  const double coverage = 1 - (1 - kShownCoverage) / static_cast<double>(looks);
  const double half_width = interval_half_width(gain.errors, coverage);
  return std::isnan(half_width) ? kFarBelow : gain.mean - half_width;
}

const CurvePoint& kept_point(const std::vector<CurvePoint>& curve) {
  const auto earned_if_shown = [](const CurvePoint& point) {
    return point.gain_at_least_eur_per_day_per_mwh < 0 ? kFarBelow
                                                       : point.validation_eur_per_day_per_mwh;
  };
  return *std::ranges::max_element(curve, {}, earned_if_shown);
}

void Replay::store(const Transition& transition) {
  if (ring_.size() < capacity_) {
    ring_.push_back(transition);
    return;
  }
  ring_[next_] = transition;
  next_ = (next_ + 1) % capacity_;
}

void Replay::play(const Teacher& teacher, std::size_t days, double epsilon, Random& random) {
  struct Episode {
    TrainingMarket::Day day;
    double soc_frac;
  };
  std::vector<Episode> episodes(days);
  std::size_t longest = 0;
  for (Episode& episode : episodes) {
    episode = {market_.days()[random.index(market_.days().size())], market_.draw_soc(random)};
    longest = std::max(longest, episode.day.count);
  }
  Matrix x = Matrix::Zero(kNetworkInputs, static_cast<Eigen::Index>(days));
  MlpTile tile;
  for (std::size_t step = 0; step < longest; ++step) {
    for (std::size_t e = 0; e < days; ++e) {
      const std::size_t at = std::min(step, episodes[e].day.count - 1);
      write_input(market_.context(episodes[e].day.first + at), episodes[e].soc_frac,
                  x.col(static_cast<Eigen::Index>(e)).data());
    }
    const Matrix values = teacher.action_values(x, tile);
    for (std::size_t e = 0; e < days; ++e) {
      if (step >= episodes[e].day.count) continue;
      const Action greedy = argmax_action(values.col(static_cast<Eigen::Index>(e)).data());
      const bool explore = random.uniform() < epsilon;
      const Action action = explore ? static_cast<Action>(random.index(kActionCount)) : greedy;
      Transition transition{};
      episodes[e].soc_frac = market_.make_transition(episodes[e].day.first + step,
                                                     episodes[e].soc_frac, action, transition);
      store(transition);
    }
  }
}

void Replay::draw(std::size_t count, Random& random, MiniBatch& batch) {
  drawn_.resize(count);
  // From a ring of a million each is a cache miss, and many are fetched in parallel.
  for (Transition& drawn : drawn_) drawn = ring_[random.index(ring_.size())];
  fill_minibatch(drawn_, batch);
}

void Replay::save(BinaryWriter& out) const {
  out.put(static_cast<std::uint64_t>(next_));
  out.put_list(ring_);
}

void Replay::restore(BinaryReader& in) {
  next_ = in.take<std::uint64_t>();
  ring_ = in.take_list<Transition>();
  const bool full = ring_.size() == capacity_;
  if (ring_.size() > capacity_ || (full ? next_ >= capacity_ : next_ != 0)) {
    in.damaged("has a replay ring of another size");
  }
}

namespace {

/// Named purposes of the run's random draws.
enum Seed : std::uint64_t { kSeedWeights = 1, kSeedExperience = 2, kSeedMinibatch = 3 };
/// Days that act in parallel with the same weights; one gradient step follows for each.
constexpr long kLockstepDays = 32;
/// Source "replay": transitions in the ring, and the share of random actions at the start and from
/// half of the steps on [SPEC 4].
constexpr std::size_t kReplayCapacity = 1'000'000;
constexpr double kEpsilonStart = 1;
constexpr double kEpsilonEnd = 0.05;

/// Source of minibatches, as configured.
class Experience {
 public:
  Experience(const TrainingMarket& market, const TrainOptions& options)
      : market_(market),
        options_(options),
        replay_(market, kReplayCapacity),
        experience_random_(derive_seed(options.seed, kSeedExperience)),
        minibatch_random_(derive_seed(options.seed, kSeedMinibatch)) {}

  const MiniBatch& next(long step, const Teacher& acting) {
    const auto count = static_cast<std::size_t>(options_.batch_size);
    if (options_.source == Source::kCounterfactual) {
      draw_counterfactual(market_, count, options_.jitter, minibatch_random_, drawn_);
      fill_minibatch(drawn_, batch_);
    } else {
      if (step % kLockstepDays == 0) {
        replay_.play(acting, kLockstepDays, epsilon(step), experience_random_);
      }
      replay_.draw(count, minibatch_random_, batch_);
    }
    return batch_;
  }

  void save(BinaryWriter& out) const {
    for (const Random* random : {&experience_random_, &minibatch_random_}) {
      out.put_text(random->state());
    }
    replay_.save(out);
  }
  void restore(BinaryReader& in) {
    for (Random* random : {&experience_random_, &minibatch_random_}) {
      if (!random->restore(in.take_text())) in.damaged("has no state of the random numbers");
    }
    replay_.restore(in);
  }

 private:
  [[nodiscard]] double epsilon(long step) const {
    const double progress =
        std::min(1.0, 2.0 * static_cast<double>(step) / static_cast<double>(options_.steps));
    return kEpsilonStart + progress * (kEpsilonEnd - kEpsilonStart);
  }

  const TrainingMarket& market_;
  const TrainOptions& options_;
  Replay replay_;
  Random experience_random_, minibatch_random_;
  std::vector<Transition> drawn_;
  MiniBatch batch_;
};

/// Stochastic program of the training days, within a limit on daily full cycles.
std::shared_ptr<const StochasticProgram> fit_program(const MarketSteps& market,
                                                     const BatteryParameters& battery,
                                                     ContextKind context) {
  const std::vector<MarketDay> training = market.days_of(Split::kTrain);
  const double level_weight = context == ContextKind::kMonth ? 0 : kLevelWeight;
  return std::make_shared<const StochasticProgram>(
      market, training,
      battery_with_shadow_price<StochasticProgramPolicy>(market, training, battery, level_weight),
      level_weight);
}

/// Program with an outlook, and classes of its break-even prices.
void fit_outlook(const MarketSteps& market, const BatteryParameters& battery, int threads,
                 Teacher& teacher) {
  if (market.day_ahead == nullptr) {
    fail(
        "[train] context = \"outlook\" needs day-ahead prices: pass their file with "
        "--day-ahead");
  }
  const std::vector<MarketDay> training = market.days_of(Split::kTrain);
  const BatteryParameters mindful =
      battery_with_shadow_price<OutlookPolicy>(market, training, battery);
  set_outlook(std::make_shared<const OutlookProgram>(market, training, mindful), teacher);
  // Every validation trades the same days.
  const std::vector<MarketDay> validation = market.days_of(Split::kValidation);
  teacher.outlook->prepare(market, validation, threads);
  teacher.plan_cache->prepare(market, training, threads);
  teacher.plan_cache->prepare(market, validation, threads);
  teacher.context = fit_outlook_classes(market, *teacher.plan_cache);
}

/// Teacher without a network: programs, price map and context classes.
Teacher without_network(const MarketSteps& market, const BatteryParameters& battery,
                        const TrainOptions& options) {
  Teacher teacher{options.method, {}, {}, PriceMap::fit(observed_training_prices(market)), {}, "",
                  nullptr};
  if (options.context == ContextKind::kOutlook) {
    fit_outlook(market, battery, options.threads, teacher);
  } else {
    teacher.context = fit_context_classes(market, options.context);
    const bool stands_on_it = options.residual || options.method == Method::kSdp;
    if (stands_on_it) teacher.program = fit_program(market, battery, options.context);
  }
  return teacher;
}

/// 1.5 times the range of 99.9 % of the returns that the program leaves, symmetric: zero is the
/// middle atom.
Support residual_support(const TrainingMarket& market, const TrainOptions& options) {
  constexpr double kLeftOut = 1e-3;
  constexpr float kRoom = 1.5F;
  std::vector<float> sizes = market.residual_returns(options.residual_gamma);
  for (float& size : sizes) size = std::abs(size);
  const auto kept = static_cast<std::ptrdiff_t>((1 - kLeftOut) * static_cast<double>(sizes.size()));
  std::ranges::nth_element(sizes, sizes.begin() + kept);
  const float reach = std::max(kRoom * sizes[static_cast<std::size_t>(kept)], kRewardScale);
  return {-reach, reach, options.atoms};
}

Support given_support(const TrainOptions& options) {
  return {static_cast<float>(options.value_min_eur_per_h) * kRewardScale,
          static_cast<float>(options.value_max_eur_per_h) * kRewardScale, options.atoms};
}

/// Training data of a run, and their weights.
struct TrainingSetup {
  Teacher teacher;  ///< without a network yet
  TrainingMarket market;
  bool adds_to_program;
  Support support;
  double gamma, mean_weight;
};

TrainingSetup set_up(const MarketSteps& market, const BatteryParameters& battery,
                     const TrainOptions& options) {
  Teacher teacher = without_network(market, battery, options);
  const BasePrograms program = options.residual ? teacher.base_programs() : BasePrograms{};
  TrainingMarket training(market, teacher.price_map, battery, options.horizon,
                          {.program = program, .threads = options.threads}, teacher.context);
  TrainingSetup setup{std::move(teacher),     std::move(training), false,
                      given_support(options), options.gamma,       options.mean_weight};
  if (!program) return setup;
  setup.adds_to_program = true;
  setup.support = residual_support(setup.market, options);
  setup.gamma = options.residual_gamma;
  setup.mean_weight /= double{setup.support.step() * setup.support.step()};
  return setup;
}

double cosine_rate(const TrainOptions& options, long step) {
  const double progress = static_cast<double>(step) / static_cast<double>(options.steps);
  const double blend = 0.5 * (1 + std::cos(std::numbers::pi * progress));
  return options.learning_rate_end + blend * (options.learning_rate - options.learning_rate_end);
}

struct ValidationStopped {};

/// Policy wrapper that may be aborted at the beginning of a day.
class StoppablePolicy final : public Policy {
 public:
  StoppablePolicy(Policy& policy, const std::function<bool()>& stop)
      : policy_(policy), stop_(stop) {}
  void begin(std::span<const MarketStep> ahead, double soc_frac) override {
    if (stop_()) throw ValidationStopped{};
    policy_.begin(ahead, soc_frac);
  }
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override {
    return policy_.decide(step, index, soc_frac);
  }

 private:
  Policy& policy_;
  const std::function<bool()>& stop_;
};

constexpr std::string_view kCheckpointMagic = "BESSCKPT";
constexpr std::uint32_t kCheckpointVersion = 2;

/// "A there and B here": the first line in which two identities differ.
std::string first_difference(std::string_view there, std::string_view here) {
  while (true) {
    const std::string_view a = take_line(there);
    const std::string_view b = take_line(here);
    if (a != b || (there.empty() && here.empty())) {
      return fmt::format("{} there and {} here", a.empty() ? "nothing" : a,
                         b.empty() ? "nothing" : b);
    }
  }
}

/// One training run, from the first step or from a checkpoint.
class Training {
 public:
  Training(const MarketSteps& market, const BatteryParameters& battery, const TrainOptions& options)
      : market_(market),
        battery_(battery),
        options_(options),
        validation_(market.days_of(Split::kValidation)),
        setup_(set_up(market, battery, options)),
        current_(setup_.teacher),
        learner_(options.method, setup_.support, setup_.gamma,
                 derive_seed(options.seed, kSeedWeights), options.threads, setup_.mean_weight),
        experience_(setup_.market, options),
        average_(learner_.online()),
        result_{current_, {}, kFarBelow, 0, 0} {
    for (Parameters* p : {&learner_.online(), &learner_.target(), &average_}) {
      if (!setup_.adds_to_program) break;
      begin_at_zero(options.method, setup_.support, learner_.shape(), *p);
    }
    for (Teacher* teacher : {&current_, &result_.teacher}) {
      teacher->support = setup_.support;
      teacher->shape = learner_.shape();
      teacher->parameters = learner_.online();
    }
  }

  void run(const std::function<bool()>& interrupted, const CheckpointOptions& checkpoint) {
    const auto start = std::chrono::steady_clock::now();
    if (checkpoint.resume) {
      try {
        restore(checkpoint);
      } catch (const UserError& error) {
        throw CheckpointUnusable(error.what());
      }
    }
    Progress progress(fmt::format("train {}", method_name(options_.method)), "steps",
                      static_cast<double>(options_.steps), static_cast<double>(step_));
    bool stopped = false;
    const auto validate_and_keep = [&] {
      stopped = !validate(interrupted);
      if (!stopped && !checkpoint.path.empty()) save(checkpoint);
    };
    if (is_validation_due()) validate_and_keep();  // it was interrupted
    while (!stopped && step_ < options_.steps && !interrupted()) {
      const double loss = learn();
      progress.update(
          static_cast<double>(step_),
          fmt::format(
              "loss {:.4f}, profit {:.1f}", loss,
              result_.curve.empty() ? 0.0 : result_.curve.back().validation_eur_per_day_per_mwh));
      if (is_validation_due()) validate_and_keep();
    }
    if ((stopped || step_ < options_.steps) && !checkpoint.path.empty()) save(checkpoint);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    result_.seconds += taken.count();
  }
  TrainResult take_result() { return std::move(result_); }

 private:
  /// One gradient step; returns its loss.
  double learn() {
    if (options_.source == Source::kReplay) current_.parameters = learner_.online();
    const MiniBatch& batch = experience_.next(step_, current_);
    const auto learned = learner_.step(batch, cosine_rate(options_, step_), options_.tau);
    average_ += static_cast<float>(1 - options_.average_decay) * (learner_.online() - average_);
    sums_.loss += learned.loss;
    sums_.edge_mass_frac += learned.edge_mass_frac;
    ++summed_;
    ++step_;
    return learned.loss;
  }

  [[nodiscard]] bool is_validation_due() const {
    const bool is_its_step = step_ % options_.validate_every == 0 || step_ == options_.steps;
    // For a residual, step 0 (the program) is also a candidate.
    const long nothing_yet = setup_.adds_to_program ? -1 : 0;
    return is_its_step &&
           step_ != (result_.curve.empty() ? nothing_yet : result_.curve.back().step);
  }

  /// Adds a point to the curve and keeps the averaged weights if it is the selected one. False,
  /// without any change, if interrupted.
  bool validate(const std::function<bool()>& interrupted) {
    current_.parameters = average_;
    TeacherPolicy teacher(current_);
    StoppablePolicy policy(teacher, interrupted);
    // The reset would favour a policy that ends its days empty.
    const EvaluationOptions evaluation{.battery = battery_, .carry_soc = true};
    Evaluation earned;
    try {
      earned = evaluate(market_, validation_, policy, evaluation);
    } catch (const ValidationStopped&) {
      return false;
    }
    const double profit = earned.profit_eur_per_day_per_mwh();
    const auto n = static_cast<double>(std::max(summed_, 1L));
    result_.curve.push_back({step_, sums_.loss / n, profit, sums_.edge_mass_frac / n,
                             setup_.adds_to_program ? gain_at_least(earned) : 0});
    sums_ = {0, 0};
    summed_ = 0;
    if (&kept_point(result_.curve) != &result_.curve.back()) return true;
    result_.best_validation_eur_per_day_per_mwh = profit;
    result_.best_step = step_;
    result_.teacher.parameters = average_;
    return true;
  }

  /// Gain over the program, whose daily profits are those of step 0.
  double gain_at_least(const Evaluation& earned) {
    if (step_ == 0) {
      for (const DayResult& day : earned.days) program_eur_.push_back(day.profit_eur);
      return 0;
    }
    const long looks = (options_.steps + options_.validate_every - 1) / options_.validate_every;
    return gain_at_least_eur_per_day_per_mwh(earned, program_eur_, looks);
  }

  void save(const CheckpointOptions& checkpoint) const {
    BinaryWriter out(kCheckpointMagic, kCheckpointVersion);
    out.put_text(checkpoint.identity);
    out.put(static_cast<std::int64_t>(step_));
    out.put(static_cast<std::int64_t>(summed_));
    out.put(sums_);
    learner_.save(out);
    put_parameters(out, average_);
    put_parameters(out, result_.teacher.parameters);
    out.put(result_.best_validation_eur_per_day_per_mwh);
    out.put(static_cast<std::int64_t>(result_.best_step));
    out.put_list(result_.curve);
    out.put_list(program_eur_);
    experience_.save(out);
    out.save(checkpoint.path);
  }

  void restore(const CheckpointOptions& checkpoint) {
    BinaryReader in(checkpoint.path, kCheckpointMagic, kCheckpointVersion, "checkpoint",
                    "retrain without --resume");
    const std::string there = in.take_text();
    if (there != checkpoint.identity) {
      in.damaged("is of another run: " + first_difference(there, checkpoint.identity));
    }
    step_ = in.take<std::int64_t>();
    summed_ = in.take<std::int64_t>();
    sums_ = in.take<Learner::StepResult>();
    learner_.restore(in);
    take_parameters(in, average_);
    take_parameters(in, result_.teacher.parameters);
    result_.best_validation_eur_per_day_per_mwh = in.take<double>();
    result_.best_step = in.take<std::int64_t>();
    result_.curve = in.take_list<CurvePoint>();
    program_eur_ = in.take_list<double>();
    experience_.restore(in);
    in.finish();
  }

  const MarketSteps& market_;
  const BatteryParameters& battery_;
  const TrainOptions& options_;
  std::vector<MarketDay> validation_;
  TrainingSetup setup_;
  Teacher& current_;  ///< teacher with the present weights
  Learner learner_;
  Experience experience_;
  Parameters average_;  ///< of the online weights
  TrainResult result_;
  std::vector<double> program_eur_;  ///< profit of step 0 on each validation day
  Learner::StepResult sums_{0, 0};   ///< since the last validation
  long summed_ = 0, step_ = 0;
};

/// No iteration: the program is fitted and solved.
TrainResult train_program(const MarketSteps& market, const BatteryParameters& battery,
                          const TrainOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  Teacher teacher = without_network(market, battery, options);
  TeacherPolicy policy(teacher);
  const EvaluationOptions evaluation{.battery = battery, .carry_soc = true};
  const double profit = evaluate(market, market.days_of(Split::kValidation), policy, evaluation)
                            .profit_eur_per_day_per_mwh();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  return {std::move(teacher), {{1, 0, profit, 0}}, profit, 1, taken.count()};
}

}  // namespace

TrainResult train_teacher(const MarketSteps& market, const BatteryParameters& battery,
                          const TrainOptions& options, const std::function<bool()>& interrupted,
                          const CheckpointOptions& checkpoint) {
  if (market.days_of(Split::kValidation).empty()) {
    fail("no validation days (local days 21 to 25) in these prices; add some");
  }
  require_training_days(market.days_of(Split::kTrain).size());
  if (options.method == Method::kSdp) return train_program(market, battery, options);
  Training training(market, battery, options);
  training.run(interrupted, checkpoint);
  return training.take_result();
}

}  // namespace bess
