#include "workstation/correction/distillation/monotone_distil.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "workstation/base/progress.h"
#include "workstation/correction/distillation/constraint_layer.h"

namespace bess {

namespace {

enum class Trend { kFalls, kRises, kFree };

constexpr int kFalling1 = 20;
constexpr int kRising1 = 20;
constexpr int kFalling2 = kStudentHidden2 / 2;
constexpr float kUnbounded = std::numeric_limits<float>::max();

Trend trend1(int unit) {
  if (unit < kFalling1) return Trend::kFalls;
  return unit < kFalling1 + kRising1 ? Trend::kRises : Trend::kFree;
}
Trend trend2(int unit) { return unit < kFalling2 ? Trend::kFalls : Trend::kRises; }

}  // namespace

SignBounds SignBounds::none() {
  SignBounds bounds;
  bounds.lower_ = Parameters::Constant(kStudentShape.parameter_count(), -kUnbounded);
  bounds.upper_ = -bounds.lower_;
  return bounds;
}

SignBounds SignBounds::monotone(const std::vector<Direction>& directions) {
  SignBounds bounds = none();
  MutableMlp lower(kStudentShape, bounds.lower_.data());
  MutableMlp upper(kStudentShape, bounds.upper_.data());
  for (int unit = 0; unit < kStudentHidden1; ++unit) {
    for (const Direction& direction : directions) {
      const int input = static_cast<int>(direction.input);
      MutableMlp& of_falling = direction.sign < 0 ? upper : lower;
      MutableMlp& of_rising = direction.sign < 0 ? lower : upper;
      if (trend1(unit) != Trend::kRises) of_falling.w1(unit, input) = 0;
      if (trend1(unit) != Trend::kFalls) of_rising.w1(unit, input) = 0;
    }
    if (trend1(unit) == Trend::kFree) continue;
    for (int next = 0; next < kStudentHidden2; ++next) {
      MutableMlp& bound = trend1(unit) == trend2(next) ? lower : upper;
      bound.w2(next, unit) = 0;
    }
  }
  constexpr auto kDischarge = static_cast<int>(Action::kDischarge);
  constexpr auto kIdle = static_cast<int>(Action::kIdle);
  constexpr auto kCharge = static_cast<int>(Action::kCharge);
  for (int unit = 0; unit < kStudentHidden2; ++unit) {
    const bool falls = trend2(unit) == Trend::kFalls;
    lower.w3(kIdle, unit) = upper.w3(kIdle, unit) = 0;
    MutableMlp& charge_bound = falls ? lower : upper;
    MutableMlp& discharge_bound = falls ? upper : lower;
    charge_bound.w3(kCharge, unit) = 0;
    discharge_bound.w3(kDischarge, unit) = 0;
  }
  return bounds;
}

void SignBounds::reflect(Parameters& parameters) const {
  for (Eigen::Index i = 0; i < parameters.size(); ++i) {
    if (parameters[i] < lower_[i] || parameters[i] > upper_[i]) parameters[i] = -parameters[i];
  }
  clamp(parameters);
}

namespace {

int lattice_value(float input, int scale) {
  return static_cast<int>(std::lround(double{input} * kInputOne / scale));
}

/// The k-th member of a set of classes.
int class_at(std::int32_t classes, std::size_t k) {
  int context_class = 0;
  while (true) {
    if ((classes >> context_class++ & 1) != 0 && k-- == 0) return context_class;
  }
}

}  // namespace

RuleSamples::RuleSamples(const RuleSet& rules, ContextKind kind)
    : kind_(kind), implied_(rules, kind) {
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    const Rule& rule = rules.rules[r];
    if (!binds_student(rule, kind) || !rule.restricts_actions()) continue;
    bound_rules_.push_back({r, rule, lattice_box_of(rule.box, kind), !rule.has_gap()});
  }
}

bool RuleSamples::holds(const BoundRule& bound_rule, const LatticeState& context) const {
  return holds_in_context(bound_rule.rule.box, kind_, context.quarter_hour, context.context_class);
}

/// The tightest state of "at least" is at the highest price and SoC, of "at most" at the lowest.
ConstraintState RuleSamples::corner(const BoundRule& bound_rule, const LatticeState& context,
                                    bool at_least) {
  const LatticeBox& box = bound_rule.box;
  return {at_least ? at_indices(context, box.soc_last, box.price_last)
                   : at_indices(context, box.soc_first, box.price_first),
          bound_rule.rule.actions(), bound_rule.index};
}

/// An operator's rule draws its hour before the minute, a built-in one after it: students in use
/// were made this way and must be reproducible from their seed.
LatticeState RuleSamples::draw_context(const BoundRule& bound_rule, Random& random) const {
  const RuleBox& box = bound_rule.rule.box;
  const bool hour_first = bound_rule.rule.property == 0;
  const auto draw_hour = [&] {
    return static_cast<int>(random.index(static_cast<std::size_t>(box.quarter_hour_count)));
  };
  int since = hour_first ? draw_hour() : 0;
  const auto minute = static_cast<int>(random.index(kMinuteOfQuarterHourCount));
  if (!hour_first) since = draw_hour();
  const auto classes = std::popcount(static_cast<unsigned>(bound_rule.box.classes));
  return lattice_context(
      minute, (box.quarter_hour_first + since) % kQuarterHourCount,
      class_at(bound_rule.box.classes, random.index(static_cast<std::size_t>(classes))));
}

ConstraintState RuleSamples::draw(std::size_t index,
                                  const std::vector<LatticeState>& counterexamples,
                                  Random& random) const {
  const BoundRule& bound_rule = bound_rules_[index];
  LatticeState context{};
  const bool wants_known = !counterexamples.empty() && random.uniform() < 0.5;
  if (wants_known) context = counterexamples[random.index(counterexamples.size())];
  if (!wants_known || !holds(bound_rule, context)) context = draw_context(bound_rule, random);
  if (!bound_rule.has_corners) {
    const auto between = [&random](int first, int last) {
      return first + static_cast<int>(random.index(static_cast<std::size_t>(last - first) + 1));
    };
    const int soc = between(bound_rule.box.soc_first, bound_rule.box.soc_last);
    const int price = between(bound_rule.box.price_first, bound_rule.box.price_last);
    return {at_indices(context, soc, price), bound_rule.rule.actions(), bound_rule.index};
  }
  const bool has_lower = bound_rule.rule.lowest() > Action::kDischarge;
  const bool has_upper = bound_rule.rule.highest() < Action::kCharge;
  const bool at_least = has_lower && (!has_upper || random.uniform() < 0.5);
  return corner(bound_rule, context, at_least);
}

void RuleSamples::corners(const LatticeState& context, std::vector<ConstraintState>& states) const {
  states.clear();
  for (const BoundRule& bound_rule : bound_rules_) {
    if (!bound_rule.has_corners || !holds(bound_rule, context)) continue;
    if (bound_rule.rule.lowest() > Action::kDischarge)
      states.push_back(corner(bound_rule, context, true));
    if (bound_rule.rule.highest() < Action::kCharge)
      states.push_back(corner(bound_rule, context, false));
  }
}

ActionSet RuleSamples::actions_at(const float* x, const PriceMap& price_map) const {
  const int price = std::clamp(static_cast<int>(std::lround(price_map.price_of(x[4]))),
                               kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh);
  return implied_.at(lattice_value(x[1], kQuarterHourScale),
                     lattice_value(x[2], kContextClassScale) + 1,
                     std::clamp(lattice_value(x[3], kSocScale), 0, kSocCount - 1), price);
}

namespace {

enum MonotoneSeed : std::uint64_t {
  kSeedMonotoneStudent = 21,
  kSeedBatches = 22,
  kSeedLessons = 23
};

constexpr float kLeak = 0.05F;  ///< gradient factor of saturated units, so that they can recover
constexpr double kRandomShare = 0.25;  ///< states from the whole lattice per visited one
constexpr double kAverageDecay = 0.998;
constexpr int kBatch = 2048;
constexpr int kRuleStates = 64;        ///< per batch and rule
constexpr float kForbiddenRegret = 4;  ///< minimum for forbidden actions, over the temperature

/// 1 in the linear part, kLeak outside.
void mask_gradient(const Matrix& sum, Matrix& gradient) {
  gradient.array() *= (sum.array() > 0.0F && sum.array() < static_cast<float>(kSaturation))
                          .select(Eigen::ArrayXXf::Ones(sum.rows(), sum.cols()), kLeak);
}

/// Restricts the teacher's choice to the allowed actions.
void obey(ActionSet allowed, Eigen::Index column, TrainingBatch& batch) {
  if (allowed == kAllActions) return;
  const Eigen::Vector3f regret = batch.regret.col(column);
  float least = std::numeric_limits<float>::max();
  for (int a = 0; a < kActionCount; ++a) {
    if (allows(allowed, static_cast<Action>(a))) least = std::min(least, regret[a]);
  }
  float sum = 0;
  for (int a = 0; a < kActionCount; ++a) {
    const bool is_allowed = allows(allowed, static_cast<Action>(a));
    const float lost = regret[a] - least;
    batch.regret(a, column) = is_allowed ? lost : std::max(lost, kForbiddenRegret);
    sum += batch.teacher_frac(a, column) = is_allowed ? std::exp(-lost) : 0.0F;
  }
  batch.teacher_frac.col(column) /= sum;
}

void saturate(const Matrix& sum, Matrix& activation) {
  activation = sum.cwiseMax(0.0F).cwiseMin(static_cast<float>(kSaturation));
}

}  // namespace

TrainingBatch make_training_states(const Teacher& teacher, const Matrix& visited,
                                   const DistilOptions& options) {
  Random random(derive_seed(options.seed, kSeedLessons));
  // Outlook: part of the visited ones, since the five inputs do not determine the action.
  const double anywhere_share = teacher.outlook ? 0 : kRandomShare;
  const auto anywhere =
      static_cast<Eigen::Index>(anywhere_share * static_cast<double>(visited.cols()));
  TrainingBatch batch;
  Matrix seen(visited.rows(), visited.cols() + anywhere);
  seen.leftCols(visited.cols()) = visited;
  for (Eigen::Index i = 0; i < anywhere; ++i) {
    float* x = seen.col(visited.cols() + i).data();
    const Eigen::Index from =
        static_cast<Eigen::Index>(random.index(static_cast<std::uint64_t>(visited.cols())));
    const int price = kLatticePriceMinEurPerMwh + static_cast<int>(random.index(kPriceCount));
    const float mapped = random.uniform() < 0.5 ? visited(4, from) : teacher.price_map(price);
    // Separate statements: within one call the compiler would choose the order of the draws.
    const int context_class = 1 + static_cast<int>(random.index(kContextClassCount));
    const auto quarter_hour = static_cast<int>(random.index(kQuarterHourCount));
    const auto minute = static_cast<int>(random.index(kMinuteOfQuarterHourCount));
    write_input(network_context(minute, quarter_hour, context_class, mapped), 0, x);
    x[3] = scaled_input(static_cast<int>(random.index(kSocCount)), kSocScale);
  }
  batch.inputs = seen.topRows(kNetworkInputs);
  MlpTile tile;
  constexpr Eigen::Index kTile = 1024;
  batch.teacher_frac.resize(kActionCount, batch.inputs.cols());
  batch.regret.resize(kActionCount, batch.inputs.cols());
  for (Eigen::Index at = 0; at < batch.inputs.cols(); at += kTile) {
    const Eigen::Index count = std::min(kTile, batch.inputs.cols() - at);
    const Eigen::MatrixXd values =
        teacher_logits(teacher, options, seen.middleCols(at, count), tile);
    batch.teacher_frac.middleCols(at, count) = log_softmax(values).array().exp().cast<float>();
    for (Eigen::Index c = 0; c < count; ++c) {
      batch.regret.col(at + c) = (values.col(c).maxCoeff() - values.col(c).array()).cast<float>();
    }
  }
  const RuleSamples rules(options.rules, teacher.context.kind);
  if (options.correct && !rules.empty()) {
    for (Eigen::Index c = 0; c < batch.inputs.cols(); ++c) {
      obey(rules.actions_at(batch.inputs.col(c).data(), teacher.price_map), c, batch);
    }
  }
  return batch;
}

MonotoneDistiller::MonotoneDistiller(const Teacher& teacher, const TrainingBatch& batch,
                                     const DistilOptions& options)
    : teacher_(teacher),
      batch_(batch),
      options_(options),
      random_(derive_seed(options.seed, kSeedBatches)),
      rules_(with_built_in(options.correction.thresholds, options.rules), teacher.context.kind),
      bounds_(options.correct ? SignBounds::monotone(options.rules.directions())
                              : SignBounds::none()),
      student_(initial_parameters(kStudentShape, derive_seed(options.seed, kSeedMonotoneStudent))),
      average_(student_),
      adam_(kStudentShape.parameter_count()),
      team_(options.threads),
      workers_(static_cast<std::size_t>(options.threads)) {
  bounds_.reflect(student_);
  spread_activations();
  average_ = student_;
}

/// Shifts and scales each hidden unit so that its sum over the training states has mean 1/2 and
/// deviation 1/2: the kinks are then where the states are.
void MonotoneDistiller::spread_activations() {
  Worker& worker = workers_.front();
  const Eigen::Index count = std::min<Eigen::Index>(4096, batch_.inputs.cols());
  worker.x.resize(kNetworkInputs, count);
  for (Eigen::Index c = 0; c < count; ++c) {
    worker.x.col(c) = batch_.inputs.col(
        static_cast<Eigen::Index>(random_.index(static_cast<std::uint64_t>(batch_.inputs.cols()))));
  }
  MutableMlp net(kStudentShape, student_.data());
  const auto spread = [&](const Matrix& sum, auto& weight, auto& bias) {
    for (Eigen::Index unit = 0; unit < sum.rows(); ++unit) {
      const float mean = sum.row(unit).mean();
      const float deviation =
          std::sqrt((sum.row(unit).array() - mean).square().sum() / static_cast<float>(count));
      const float scale = 0.5F / std::max(deviation, 1e-3F);
      weight.row(unit) *= scale;
      bias[unit] = (bias[unit] - mean) * scale + 0.5F;
    }
    for (Eigen::Index unit = 0; unit < sum.rows(); ++unit) {
      bias[unit] += static_cast<float>(random_.normal()) * 0.5F;
    }
  };
  forward(student_, worker);
  spread(worker.a1, net.w1, net.b1);
  forward(student_, worker);
  spread(worker.a2, net.w2, net.b2);
}

void MonotoneDistiller::forward(const Parameters& parameters, Worker& w) const {
  const ConstMlp net(kStudentShape, parameters.data());
  w.a1.noalias() = net.w1 * w.x;
  w.a1.colwise() += net.b1;
  saturate(w.a1, w.h1);
  w.a2.noalias() = net.w2 * w.h1;
  w.a2.colwise() += net.b2;
  saturate(w.a2, w.h2);
  w.z.noalias() = net.w3 * w.h2;
  w.z.colwise() += net.b3;
}

void MonotoneDistiller::draw_batch(const std::vector<LatticeState>& counterexamples, Worker& w) {
  w.learnt = kBatch / static_cast<Eigen::Index>(workers_.size());
  const std::size_t hinged = options_.correct ? rules_.count() * kRuleStates : 0;
  w.x.resize(kNetworkInputs, w.learnt + static_cast<Eigen::Index>(hinged));
  w.target.resize(kActionCount, w.learnt);
  w.regret.resize(kActionCount, w.learnt);
  for (Eigen::Index c = 0; c < w.learnt; ++c) {
    const auto from =
        static_cast<Eigen::Index>(random_.index(static_cast<std::uint64_t>(batch_.inputs.cols())));
    w.x.col(c) = batch_.inputs.col(from);
    w.target.col(c) = batch_.teacher_frac.col(from);
    w.regret.col(c) = batch_.regret.col(from);
  }
  w.allowed.clear();
  for (std::size_t n = 0; n < hinged; ++n) {
    const ConstraintState drawn = rules_.draw(n / kRuleStates, counterexamples, random_);
    float* x = w.x.col(w.learnt + static_cast<Eigen::Index>(n)).data();
    write_input(network_context(drawn.state.minute_of_quarter_hour, drawn.state.quarter_hour,
                                drawn.state.context_class,
                                teacher_.price_map(drawn.state.price_eur_per_mwh)),
                0, x);
    x[3] = scaled_input(drawn.state.soc_index, kSocScale);
    w.allowed.push_back(drawn.actions);
  }
}

/// Adds the gradient of this worker's share of the batch.
void MonotoneDistiller::learn(Worker& w, double scale) const {
  forward(student_, w);
  w.dz.setZero(kActionCount, w.z.cols());
  w.loss = 0;
  const auto margin = static_cast<float>(options_.correction.logit_margin);
  const auto share = static_cast<float>(scale);
  const auto fidelity = static_cast<float>(options_.fidelity);
  for (Eigen::Index c = 0; c < w.learnt; ++c) {
    const float* z = w.z.col(c).data();
    const float highest = std::max({z[0], z[1], z[2]});
    float p[kActionCount];
    float sum = 0;
    for (int a = 0; a < kActionCount; ++a) sum += p[a] = std::exp(z[a] - highest);
    float expected = 0;
    for (int a = 0; a < kActionCount; ++a) expected += (p[a] /= sum) * w.regret(a, c);
    w.loss += scale * double{expected};
    // Cross-entropy finds the teacher's action from any start; expected regret then spends the
    // net's capacity where it pays.
    for (int a = 0; a < kActionCount; ++a) {
      w.dz(a, c) =
          share * (fidelity * (p[a] - w.target(a, c)) + p[a] * (w.regret(a, c) - expected));
    }
  }
  // Hinge losses of all rules on u = charge - idle and v = idle - discharge.
  for (Eigen::Index c = w.learnt; c < w.z.cols(); ++c) {
    const double u = w.z(2, c) - w.z(1, c);
    const double v = w.z(1, c) - w.z(0, c);
    const ActionSet allowed = w.allowed[static_cast<std::size_t>(c - w.learnt)];
    for (const ScoreRow& row : ScoreRows(allowed, u, v, double{margin})) {
      if (row.on_u * u + row.on_v * v >= row.at_least) continue;
      const auto push_u = static_cast<float>(4 * scale * row.on_u);
      const auto push_v = static_cast<float>(4 * scale * row.on_v);
      w.dz(2, c) -= push_u;
      w.dz(1, c) += push_u - push_v;
      w.dz(0, c) += push_v;
    }
  }
  const ConstMlp net(kStudentShape, student_.data());
  MutableMlp gradient(kStudentShape, w.gradient.data());
  gradient.w3.noalias() += w.dz * w.h2.transpose();
  gradient.b3 += w.dz.rowwise().sum();
  w.d2.noalias() = net.w3.transpose() * w.dz;
  mask_gradient(w.a2, w.d2);
  gradient.w2.noalias() += w.d2 * w.h1.transpose();
  gradient.b2 += w.d2.rowwise().sum();
  w.d1.noalias() = net.w2.transpose() * w.d2;
  mask_gradient(w.a1, w.d1);
  gradient.w1.noalias() += w.d1 * w.x.transpose();
  gradient.b1 += w.d1.rowwise().sum();
}

void MonotoneDistiller::run(int epochs, const std::vector<LatticeState>& counterexamples,
                            const std::atomic<bool>& interrupted,
                            const std::function<void(double done)>& look) {
  Progress progress(options_.correct ? "distil, monotone" : "distil", "epochs", epochs);
  for (int epoch = 0; epoch < epochs && !interrupted; ++epoch) {
    const double blend = 0.5 * (1 + std::cos(std::numbers::pi * epoch / epochs));
    const auto rate = static_cast<float>(options_.learning_rate * (0.01 + 0.99 * blend));
    double loss = 0;
    for (int s = 0; s < options_.steps_per_epoch; ++s) {
      for (Worker& worker : workers_) draw_batch(counterexamples, worker);
      team_.run([&](int member) {
        Worker& worker = workers_[static_cast<std::size_t>(member)];
        worker.gradient.setZero(kStudentShape.parameter_count());
        learn(worker, 1.0 / kBatch);
      });
      for (std::size_t w = 1; w < workers_.size(); ++w)
        workers_[0].gradient += workers_[w].gradient;
      for (const Worker& worker : workers_) loss += worker.loss / options_.steps_per_epoch;
      adam_.update(student_, workers_[0].gradient, rate);
      bounds_.clamp(student_);
      average_ += static_cast<float>(1 - kAverageDecay) * (student_ - average_);
    }
    curve_.push_back({static_cast<int>(curve_.size()) + 1, 0, 0, loss});
    progress.update(epoch + 1, fmt::format("regret {:.4f}", loss));
    look(static_cast<double>(epoch + 1) / epochs);
  }
}

}  // namespace bess
