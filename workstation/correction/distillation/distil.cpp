#include "workstation/correction/distillation/distil.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <span>

#include "shared/host/user_error.h"
#include "workstation/base/parallel_for.h"
#include "workstation/base/progress.h"

namespace bess {

namespace {

constexpr std::uint64_t kSeedOutlook = 14;
constexpr int kPasses = 4;
constexpr double kExploration = 0.1;
constexpr double kElsewhereShare = 0.25;  ///< additional training states at another price and SoC
constexpr double kElsewhereEurPerMwh = 200;
constexpr int kRows = kNetworkInputs + kActionCount;

/// One simulated pass over a day from its own SoC, with all prices shifted.
struct Pass {
  double soc_frac;
  double shift_eur_per_mwh;
};

class TrainingSet {
 public:
  TrainingSet(const Teacher& teacher, const BatteryParameters& battery)
      : teacher_(teacher), per_eur_(learned_per_eur(battery)), x_(kNetworkInputs, 1) {}

  /// Adds a training state; returns the teacher's action.
  Action add(const MarketStep& step, double soc_frac, double shift_eur_per_mwh,
             OutlookProgram::Plan& plan) {
    auto worth_eur = teacher_.outlook->action_values(step, soc_frac, plan);
    if (teacher_.is_residual()) teacher_.add_network(step, soc_frac, x_, tile_, worth_eur);
    const std::int32_t break_even_centi = teacher_.plan_cache->break_even_centi(step, soc_frac);
    const std::int16_t context_class =
        teacher_.context.class_of(step.month, break_even_centi + price_centi_of(shift_eur_per_mwh));
    float x[kRows];
    write_input(network_context(step.minute_of_quarter_hour, step.quarter_hour, context_class,
                                teacher_.price_map(step.observed_eur_per_mwh + shift_eur_per_mwh)),
                soc_frac, x);
    for (int a = 0; a < kActionCount; ++a) {
      x[kNetworkInputs + a] = static_cast<float>((worth_eur[a] - worth_eur[1]) * per_eur_);
    }
    all_.insert(all_.end(), x, x + kRows);
    return argmax_action(worth_eur.data());
  }
  [[nodiscard]] Eigen::Map<const Matrix> training_states() const {
    return {all_.data(), kRows, static_cast<Eigen::Index>(all_.size() / kRows)};
  }

 private:
  const Teacher& teacher_;
  double per_eur_;
  Matrix x_;
  MlpTile tile_;
  std::vector<float> all_;
};

MarketStep elsewhere(MarketStep step, Random& random) {
  if (random.uniform() < 0.5) {
    step.observed_eur_per_mwh = kLatticePriceMinEurPerMwh + random.uniform() * (kPriceCount - 1);
  } else {
    step.observed_eur_per_mwh += kElsewhereEurPerMwh * random.normal();
  }
  return step;
}

/// Draws a day's training states in order of time; `add` adds one and returns the teacher's action.
template <typename Add>
void trade_day(std::span<const MarketStep> steps, const BatteryParameters& battery,
               double level_shift_eur_per_mwh, Random& random, Add add) {
  const double window_frac = battery.soc_max_frac - battery.soc_min_frac;
  std::vector<Pass> passes;
  for (int p = 0; p < kPasses; ++p) {
    const double soc_frac = battery.soc_min_frac + random.uniform() * window_frac;
    passes.push_back({soc_frac, p == 0 ? 0.0 : level_shift_eur_per_mwh * random.normal()});
  }
  for (const MarketStep& step : steps) {
    for (Pass& pass : passes) {
      Action action = add(step, pass.soc_frac, pass.shift_eur_per_mwh);
      if (random.uniform() < kElsewhereShare) {
        const MarketStep other = elsewhere(step, random);
        add(other, battery.soc_min_frac + random.uniform() * window_frac, pass.shift_eur_per_mwh);
      }
      if (random.uniform() < kExploration) action = static_cast<Action>(random.index(kActionCount));
      const double wanted_w = power_sign(action) * battery.power_w_at(step.quarter_hour);
      pass.soc_frac = battery_step(battery, pass.soc_frac, wanted_w, kHoursPerStep).soc_frac;
    }
  }
}

Matrix joined(const std::vector<TrainingSet>& sets) {
  Eigen::Index count = 0;
  for (const TrainingSet& set : sets) count += set.training_states().cols();
  Matrix all(kRows, count);
  Eigen::Index at = 0;
  for (const TrainingSet& set : sets) {
    all.middleCols(at, set.training_states().cols()) = set.training_states();
    at += set.training_states().cols();
  }
  return all;
}

}  // namespace

Matrix outlook_lessons(const Teacher& teacher, const MarketSteps& market,
                       const BatteryParameters& battery, const DistilOptions& options) {
  if (market.day_ahead == nullptr) {
    fail("this teacher plans on day-ahead prices: give their file to distil with --day-ahead");
  }
  const std::vector<MarketDay> days = market.days_of(Split::kTrain);
  const auto trade = [&](std::size_t d, Random& random, auto add) {
    trade_day(market.of(days[d]), battery, options.level_shift_eur_per_mwh, random, add);
  };
  // The draws do not depend on the plans: the generator's state at each day is known in advance.
  Random random(derive_seed(options.seed, kSeedOutlook));
  std::vector<Random> draws;
  for (std::size_t d = 0; d < days.size(); ++d) {
    draws.push_back(random);
    trade(d, random, [](const MarketStep&, double, double) { return Action::kIdle; });
  }
  std::vector<TrainingSet> sets(days.size(), TrainingSet(teacher, battery));
  parallel_for(days.size(), options.threads, [&](std::size_t d) {
    OutlookProgram::Plan plan;
    trade(d, draws[d], [&](const MarketStep& step, double soc_frac, double shift_eur_per_mwh) {
      if (!plan.serves(step)) plan = teacher.outlook->plan_of(step);
      return sets[d].add(step, soc_frac, shift_eur_per_mwh, plan);
    });
  });
  return joined(sets);
}

Eigen::MatrixXd log_softmax(const Eigen::MatrixXd& logits) {
  Eigen::MatrixXd shifted = logits.rowwise() - logits.colwise().maxCoeff().eval();
  const Eigen::RowVectorXd log_sum = shifted.array().exp().colwise().sum().log();
  shifted.rowwise() -= log_sum;
  return shifted;
}

double kl_divergence(const Eigen::MatrixXd& log_p, const Eigen::MatrixXd& log_q) {
  return (log_p.array().exp() * (log_p - log_q).array()).sum();
}

Eigen::MatrixXd kl_gradient_first(const Eigen::MatrixXd& log_p, const Eigen::MatrixXd& log_q) {
  const Eigen::ArrayXXd p = log_p.array().exp();
  const Eigen::ArrayXXd difference = (log_p - log_q).array();
  const Eigen::RowVectorXd kl = (p * difference).colwise().sum();
  return p * (difference.rowwise() - kl.array());
}

Eigen::MatrixXd kl_gradient_second(const Eigen::MatrixXd& log_p, const Eigen::MatrixXd& log_q) {
  return log_q.array().exp() - log_p.array().exp();
}

namespace {

enum Seed : std::uint64_t { kSeedStudent = 11, kSeedLattices = 12, kSeedVisited = 13 };
/// Passes over the training days, each from its own initial SoC, with this share of random actions.
constexpr int kVisitedPasses = 4;
constexpr double kVisitedExploration = 0.1;
/// Range around a counterexample: rows in EUR/MWh and columns in SoC steps.
constexpr int kCounterexamplePriceReach = 40;
constexpr int kCounterexampleSocReach = 10;

/// With rules: half the prices and SoCs, four times the lattices, the same number of states.
DistilOptions with_room_for_rules(DistilOptions options) {
  if (options.rules.empty()) return options;
  options.lattice_prices = std::max(8, options.lattice_prices / 2);
  options.lattice_socs = std::max(6, options.lattice_socs / 2);
  options.lattices_per_epoch *= 4;
  return options;
}

int clamped(int value, int low, int high) { return std::clamp(value, low, high); }

/// Fills `axis` with sorted distinct values up to `count`, drawing more from `draw`.
template <typename Draw>
void fill_distinct(std::vector<int>& axis, int count, Draw draw) {
  std::ranges::sort(axis);
  axis.erase(std::unique(axis.begin(), axis.end()), axis.end());
  while (static_cast<int>(axis.size()) < count) {
    const int value = draw();
    const auto at = std::ranges::lower_bound(axis, value);
    if (at == axis.end() || *at != value) axis.insert(at, value);
  }
}

}  // namespace

Matrix visited_inputs(const Teacher& teacher, const MarketSteps& market,
                      const BatteryParameters& battery, const DistilOptions& options) {
  if (teacher.outlook) return outlook_lessons(teacher, market, battery, options);
  Random random(derive_seed(options.seed, kSeedVisited));
  const std::vector<MarketDay> training = market.days_of(Split::kTrain);
  std::size_t steps = 0;
  for (const MarketDay& day : training) steps += day.step_count;
  Matrix visited(kNetworkInputs, static_cast<Eigen::Index>(steps * kVisitedPasses));
  Eigen::Index at = 0;
  // All days of all passes in parallel: one forward pass with many columns per step of the day.
  struct Episode {
    std::span<const MarketStep> steps;
    double soc_frac;
    double shift_eur_per_mwh;
  };
  std::vector<Episode> episodes;
  std::size_t longest = 0;
  for (int pass = 0; pass < kVisitedPasses; ++pass) {
    for (const MarketDay& day : training) {
      const double soc =
          battery.soc_min_frac + random.uniform() * (battery.soc_max_frac - battery.soc_min_frac);
      // Covers the price levels of other years, where the teacher knows them.
      const bool moves = pass > 0 && teacher.program != nullptr;
      const double shift = moves ? options.level_shift_eur_per_mwh * random.normal() : 0;
      episodes.push_back({market.of(day), soc, shift});
      longest = std::max(longest, day.step_count);
    }
  }
  MlpTile tile;
  for (std::size_t step = 0; step < longest; ++step) {
    const Eigen::Index first = at;
    for (const Episode& episode : episodes) {
      if (step >= episode.steps.size()) continue;
      MarketStep seen = episode.steps[step];
      seen.observed_eur_per_mwh += episode.shift_eur_per_mwh;
      seen.level_centi_eur_per_mwh += price_centi_of(episode.shift_eur_per_mwh);
      teacher.write_inputs(seen, episode.soc_frac, visited.col(at++).data());
    }
    const Matrix values = teacher.action_values(visited.middleCols(first, at - first), tile);
    Eigen::Index column = 0;
    for (Episode& episode : episodes) {
      if (step >= episode.steps.size()) continue;
      Action action = argmax_action(values.col(column++).data());
      if (random.uniform() < kVisitedExploration) {
        action = static_cast<Action>(random.index(kActionCount));
      }
      const double wanted_w =
          power_sign(action) * battery.power_w_at(episode.steps[step].quarter_hour);
      episode.soc_frac = battery_step(battery, episode.soc_frac, wanted_w, kHoursPerStep).soc_frac;
    }
  }
  return visited;
}

Eigen::MatrixXd teacher_logits(const Teacher& teacher, const DistilOptions& options,
                               const MatrixRef& x, MlpTile& tile) {
  const double inverse_temperature = 1 / (options.temperature_eur_per_h * double{kRewardScale});
  return teacher.action_values(x, tile).cast<double>() * inverse_temperature;
}

Distiller::Distiller(const Teacher& teacher, const Matrix& visited, const DistilOptions& options)
    : teacher_(teacher),
      visited_(visited),
      options_(with_room_for_rules(options)),
      random_(derive_seed(options.seed, kSeedLattices)),
      student_(initial_parameters(kStudentShape, derive_seed(options.seed, kSeedStudent))),
      adam_(kStudentShape.parameter_count()),
      team_(options.threads),
      workers_(static_cast<std::size_t>(options.threads)) {}

void Distiller::draw_axes(const LatticeState* centre, LatticeAxes& axes) {
  const auto visited_price = [this] {  // an observed network input, back to EUR/MWh
    const auto column = static_cast<Eigen::Index>(random_.index(visited_.cols()));
    const auto& table = teacher_.price_map.table();
    const auto mapped = static_cast<std::int16_t>(visited_(4, column) * kInputOne);
    return static_cast<int>(std::ranges::lower_bound(table, mapped) - table.begin()) +
           kLatticePriceMinEurPerMwh;
  };
  const auto draw_price = [&] {
    if (centre != nullptr && random_.uniform() < 0.7) {
      const auto shift = static_cast<int>(random_.index(2 * kCounterexamplePriceReach + 1));
      return centre->price_eur_per_mwh + shift - kCounterexamplePriceReach;
    }
    if (random_.uniform() < 0.5) return visited_price();
    return kLatticePriceMinEurPerMwh + static_cast<int>(random_.index(kPriceCount));
  };
  const auto draw_soc = [&] {
    if (centre != nullptr && random_.uniform() < 0.7) {
      const auto shift = static_cast<int>(random_.index(2 * kCounterexampleSocReach + 1));
      return centre->soc_index + shift - kCounterexampleSocReach;
    }
    return static_cast<int>(random_.index(kSocCount));
  };
  const PriceThresholds& thresholds = options_.correction.thresholds;
  axes.price_eur_per_mwh = {kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh};
  for (const int threshold : {thresholds.low_eur_per_mwh, thresholds.high_eur_per_mwh}) {
    axes.price_eur_per_mwh.push_back(
        clamped(threshold, kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh));
  }
  if (centre != nullptr) axes.price_eur_per_mwh.push_back(centre->price_eur_per_mwh);
  fill_distinct(axes.price_eur_per_mwh, options_.lattice_prices, [&] {
    return clamped(draw_price(), kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh);
  });
  std::vector<int> socs{0, kSocCount - 1};
  if (centre != nullptr) socs.push_back(centre->soc_index);
  fill_distinct(socs, options_.lattice_socs, [&] { return clamped(draw_soc(), 0, kSocCount - 1); });
  axes.mapped_price.clear();
  for (const int price : axes.price_eur_per_mwh) {
    axes.mapped_price.push_back(double{teacher_.price_map(price)});
  }
  axes.soc.clear();
  for (const int soc : socs) axes.soc.push_back(double{scaled_input(soc, kSocScale)});
}

Distiller::Lattice Distiller::draw_lattice(const std::vector<LatticeState>& counterexamples,
                                           bool near_counterexample) {
  Lattice lattice;
  if (near_counterexample) {
    const LatticeState& centre = counterexamples[random_.index(counterexamples.size())];
    const auto nearby = [this](int value, int low, int high) {
      return clamped(value + static_cast<int>(random_.index(3)) - 1, low, high);
    };
    lattice.minute_of_quarter_hour =
        nearby(centre.minute_of_quarter_hour, 0, kMinuteOfQuarterHourCount - 1);
    lattice.quarter_hour = nearby(centre.quarter_hour, 0, kQuarterHourCount - 1);
    lattice.context_class = nearby(centre.context_class, 1, kContextClassCount);
    draw_axes(&centre, lattice.axes);
    return lattice;
  }
  lattice.minute_of_quarter_hour = static_cast<int>(random_.index(kMinuteOfQuarterHourCount));
  lattice.quarter_hour = static_cast<int>(random_.index(kQuarterHourCount));
  lattice.context_class = 1 + static_cast<int>(random_.index(kContextClassCount));
  draw_axes(nullptr, lattice.axes);
  return lattice;
}

void Distiller::lattice_inputs(const Lattice& lattice, Matrix& x) const {
  const auto& axes = lattice.axes;
  x.resize(kNetworkInputs, static_cast<Eigen::Index>(axes.soc.size() * axes.mapped_price.size()));
  Eigen::Index at = 0;
  for (const double price : axes.mapped_price) {
    const NetworkContext context =
        network_context(lattice.minute_of_quarter_hour, lattice.quarter_hour, lattice.context_class,
                        static_cast<float>(price));
    for (const double soc : axes.soc) {
      float* column = x.col(at++).data();
      write_input(context, 0, column);
      column[3] = static_cast<float>(soc);
    }
  }
}

/// log mu of the teacher's inputs: log softmax of its values over the temperature.
Eigen::MatrixXd Distiller::teacher_log_policy(const Matrix& seen, Worker& worker) const {
  return log_softmax(teacher_logits(teacher_, options_, seen, worker.teacher_tile));
}

void Distiller::backward_student(Worker& worker) const {
  const ConstMlp student(kStudentShape, student_.data());
  MutableMlp gradient(kStudentShape, worker.gradient.data());
  backward_head(student, worker.dz, worker.student_tile, gradient);
  backward_hidden(student, worker.x, worker.student_tile, gradient);
}

/// Nothing if no rule names a state of the lattice.
std::optional<ConstraintLayer> Distiller::layer_with_rules(
    const Lattice& lattice, const CorrectionOptions& correction) const {
  const LatticeState context =
      lattice_context(lattice.minute_of_quarter_hour, lattice.quarter_hour, lattice.context_class);
  std::vector<DifferenceRow> rows =
      lattice_rows(options_.rules, teacher_.context.kind, context, lattice.axes, correction);
  if (rows.empty()) return {};
  std::ranges::move(property_rows(correction, lattice.axes), std::back_inserter(rows));
  return ConstraintLayer(std::move(rows), options_.lattice_prices * options_.lattice_socs);
}

void Distiller::learn_lattice(const Lattice& lattice, CorrectionLayer& layer, double weight,
                              Worker& worker) {
  const ConstMlp student(kStudentShape, student_.data());
  lattice_inputs(lattice, worker.x);
  const Eigen::MatrixXd log_mu = teacher_log_policy(worker.x, worker);
  forward_hidden(student, worker.x, worker.student_tile);
  forward_head(student, worker.student_tile, worker.z);
  const Eigen::MatrixXd logits = worker.z.cast<double>();
  const Eigen::MatrixXd log_student = log_softmax(logits);
  if (!options_.correct) {
    worker.losses.teacher += weight * kl_divergence(log_student, log_mu);
    worker.dz = (weight * options_.omega * kl_gradient_first(log_student, log_mu)).cast<float>();
    backward_student(worker);
    return;
  }
  Eigen::MatrixXd corrected, through_layer;
  std::optional<ConstraintLayer> general = layer_with_rules(lattice, layer.options());
  general ? general->forward(logits, corrected) : layer.forward(lattice.axes, logits, corrected);
  const Eigen::MatrixXd log_corrected = log_softmax(corrected);
  worker.losses.teacher += weight * kl_divergence(log_corrected, log_mu);
  worker.losses.correction += weight * kl_divergence(log_student, log_corrected);
  const Eigen::MatrixXd gradient_corrected =
      options_.omega * kl_gradient_first(log_corrected, log_mu) +
      kl_gradient_second(log_student, log_corrected);
  general ? general->backward(gradient_corrected, through_layer)
          : layer.backward(gradient_corrected, through_layer);
  worker.dz =
      (weight * (through_layer + kl_gradient_first(log_student, log_corrected))).cast<float>();
  backward_student(worker);
}

void Distiller::learn_visited(const std::vector<Eigen::Index>& columns, double weight,
                              Worker& worker) {
  const ConstMlp student(kStudentShape, student_.data());
  worker.seen.resize(visited_.rows(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    worker.seen.col(static_cast<Eigen::Index>(c)) = visited_.col(columns[c]);
  }
  worker.x = worker.seen.topRows(kNetworkInputs);
  const Eigen::MatrixXd log_mu = teacher_log_policy(worker.seen, worker);
  forward_hidden(student, worker.x, worker.student_tile);
  forward_head(student, worker.student_tile, worker.z);
  const Eigen::MatrixXd log_student = log_softmax(worker.z.cast<double>());
  worker.losses.visited += weight * kl_divergence(log_student, log_mu);
  worker.dz = (weight * options_.omega * kl_gradient_first(log_student, log_mu)).cast<float>();
  backward_student(worker);
}

Distiller::Losses Distiller::step(const std::vector<Lattice>& lattices,
                                  std::vector<CorrectionLayer>& layers,
                                  const std::vector<Eigen::Index>& visited, double learning_rate) {
  const double lattice_weight =
      1.0 / static_cast<double>(lattices.size() * options_.lattice_prices * options_.lattice_socs);
  const double visited_weight = 1.0 / static_cast<double>(visited.size());
  team_.run([&](int index) {
    Worker& worker = workers_[static_cast<std::size_t>(index)];
    worker.gradient.setZero(kStudentShape.parameter_count());
    worker.losses = {};
    const auto team = static_cast<std::size_t>(team_.size());
    try {
      for (auto l = static_cast<std::size_t>(index); l < lattices.size(); l += team) {
        learn_lattice(lattices[l], layers[static_cast<std::size_t>(index)], lattice_weight, worker);
      }
    } catch (const UserError& error) {  // contradicting rows; a job of the team must not throw
      worker.complaint = error.what();
    }
    const std::size_t share = (visited.size() + team - 1) / team;
    const std::size_t begin = std::min(visited.size(), share * static_cast<std::size_t>(index));
    const std::size_t end = std::min(visited.size(), begin + share);
    if (begin < end) {
      learn_visited({visited.begin() + static_cast<std::ptrdiff_t>(begin),
                     visited.begin() + static_cast<std::ptrdiff_t>(end)},
                    visited_weight, worker);
    }
  });
  Losses losses;
  for (std::size_t w = 0; w < workers_.size(); ++w) {
    if (!workers_[w].complaint.empty()) fail("{}", workers_[w].complaint);
    if (w > 0) workers_[0].gradient += workers_[w].gradient;
    losses.teacher += workers_[w].losses.teacher;
    losses.correction += workers_[w].losses.correction;
    losses.visited += workers_[w].losses.visited;
  }
  adam_.update(student_, workers_[0].gradient, static_cast<float>(learning_rate));
  return losses;
}

void Distiller::run(int epochs, const std::vector<LatticeState>& counterexamples,
                    double margin_scale, const std::atomic<bool>& interrupted) {
  CorrectionOptions correction = options_.correction;
  correction.price_slope *= margin_scale;
  correction.soc_slope *= margin_scale;
  std::vector<CorrectionLayer> layers;
  for (int i = 0; i < team_.size(); ++i) {
    layers.emplace_back(correction, options_.lattice_prices, options_.lattice_socs);
  }
  const int steps = options_.steps_per_epoch;
  const int lattices_per_step = std::max(1, options_.lattices_per_epoch / steps);
  const int visited_per_step = std::max(1, options_.visited_per_epoch / steps);
  Progress progress(options_.correct ? "correct, distil" : "distil", "epochs", epochs);
  for (int epoch = 0; epoch < epochs && !interrupted; ++epoch) {
    const double blend = 0.5 * (1 + std::cos(std::numbers::pi * epoch / epochs));
    const double rate = options_.learning_rate * (0.1 + 0.9 * blend);
    Losses mean;
    for (int s = 0; s < steps; ++s) {
      std::vector<Lattice> lattices;
      for (int l = 0; l < lattices_per_step; ++l) {
        lattices.push_back(draw_lattice(counterexamples, !counterexamples.empty() && l % 2 == 0));
      }
      std::vector<Eigen::Index> columns(static_cast<std::size_t>(visited_per_step));
      for (Eigen::Index& c : columns) c = static_cast<Eigen::Index>(random_.index(visited_.cols()));
      const Losses losses = step(lattices, layers, columns, rate);
      mean.teacher += losses.teacher / steps;
      mean.correction += losses.correction / steps;
      mean.visited += losses.visited / steps;
    }
    curve_.push_back(
        {static_cast<int>(curve_.size()) + 1, mean.teacher, mean.correction, mean.visited});
    progress.update(epoch + 1,
                    fmt::format("KL {:.4f}, layer {:.1e}", mean.visited, mean.correction));
  }
}

}  // namespace bess
