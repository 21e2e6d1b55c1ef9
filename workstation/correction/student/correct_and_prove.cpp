#include "workstation/correction/student/correct_and_prove.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/correction/distillation/monotone_distil.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/correction/student/student_policy.h"
#include "workstation/data/env/evaluate.h"

namespace bess {
namespace {

/// Factor of the slope margins from one repair round to the next: only rounding errors remain.
constexpr double kMarginGrowth = 1.4;

std::string provenance_of(const Teacher& teacher, const DistilOptions& options) {
  const std::string rules = options.correct && !options.rules.empty()
                                ? ", " + counted(options.rules.rules.size(), "rule")
                                : "";
  if (options.method == CorrectionMethod::kConstruction) {
    return fmt::format("{}; {}, fidelity {:g}, {} epochs, seed {}{}", teacher.provenance,
                       options.correct ? "monotone by construction" : "plain", options.fidelity,
                       options.epochs, options.seed, rules);
  }
  return fmt::format("{}; {} omega {:g}, {} epochs, seed {}", teacher.provenance,
                     options.correct ? "corrected," : "plain,", options.omega, options.epochs,
                     options.seed);
}

/// A plain student serves as a comparison: its violations are sampled, not repaired.
Verdict judge(StudentFile student, const DistilOptions& options) {
  if (options.correct) return prove(std::move(student), options.threads);
  return sample_violations(std::move(student), options.threads);
}

/// A student during training and its validation result.
struct Candidate {
  StudentNet net;
  ValidationResult validation;
  int epoch;
  [[nodiscard]] double score() const { return validation.profit; }
};

/// Rounded as in the file, so that an exported header is reproducible.
void note_cycles(const ValidationResult& validation, StudentFile& student) {
  if (!std::isfinite(validation.cycles_per_day)) return;  // no validation day
  student.cycles_per_day = std::round(validation.cycles_per_day * 100) / 100;
}

/// Appends the candidates of a round (ordered by score) in order of time; those before `chosen`
/// violate a demand.
void note_checkpoints(const std::vector<Candidate>& candidates, std::size_t chosen, int round,
                      std::vector<StudentCheckpoint>& checkpoints) {
  const auto before = static_cast<std::ptrdiff_t>(checkpoints.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const CheckpointState state = i < chosen    ? CheckpointState::kDisobeys
                                  : i == chosen ? CheckpointState::kChosen
                                                : CheckpointState::kPassedOver;
    checkpoints.push_back({round, candidates[i].epoch, candidates[i].score(), state});
  }
  std::sort(
      checkpoints.begin() + before, checkpoints.end(),
      [](const StudentCheckpoint& a, const StudentCheckpoint& b) { return a.epoch < b.epoch; });
}

/// States in which a monotone student violates a rule, checked at the corners of its box; for a
/// threshold at its price. Fast, where a proof takes seconds.
Certificate check_corners(const StudentNet& net, const DistilOptions& options,
                          const RuleSamples& rules) {
  Certificate found{.thresholds = options.correction.thresholds, .rules = options.rules};
  for (const Rule& rule : found.demands().rules) {
    found.counts.push_back({binds_student(rule, net.context.kind)});
  }
  std::vector<ConstraintState> corners;
  for (int c = 0; c < kContextCount; ++c) {
    rules.corners(context_at(c), corners);
    for (const ConstraintState& corner : corners) {
      if (allows(corner.actions, net.decide(corner.state))) continue;
      found.counterexamples.push_back(corner.state);
      ++found.counts[corner.rule].violations;
    }
  }
  return found;
}

/// Reports each round with an estimate of the remaining time.
class RoundReporter {
 public:
  RoundReporter(const DistilOptions& options, const RoundWatch& watch)
      : watch_(watch),
        most_(options.correct ? 1 + static_cast<std::size_t>(options.repair_rounds) : 1),
        repair_share_(std::min(
            1.0, static_cast<double>(options.repair_epochs) / std::max(1, options.epochs))) {}

  [[nodiscard]] std::size_t most() const { return most_; }
  void add(ProofRound round, std::vector<ProofRound>& rounds) {
    const auto now = std::chrono::steady_clock::now();
    const double took_s = std::chrono::duration<double>(now - start_).count();
    start_ = now;
    rounds.push_back(std::move(round));
    const double next_s = rounds.size() == 1 ? took_s * repair_share_ : took_s;
    const auto left = static_cast<double>(most_ - rounds.size());
    if (watch_) watch_(rounds.back(), {rounds.size(), most_, left * next_s});
  }

 private:
  const RoundWatch& watch_;
  std::size_t most_;
  double repair_share_;  ///< time of a repair over that of the first round
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Monotone by construction: the proof can fail only at the rules and thresholds.
CorrectionResult construct_and_prove(const Teacher& teacher, const Matrix& visited,
                                     const DistilOptions& options,
                                     const std::atomic<bool>& interrupted,
                                     const StudentScore& score, const RoundWatch& watch,
                                     StudentFile student) {
  constexpr double kFirstLook = 0.5;  ///< share of the epochs before the first check
  constexpr int kLooks = 16;
  const TrainingBatch batch = make_training_states(teacher, visited, options);
  MonotoneDistiller distiller(teacher, batch, options);
  const RuleSamples rules(with_built_in(options.correction.thresholds, options.rules),
                          teacher.context.kind);
  CorrectionResult result{.verdict = student, .curve = {}, .rounds = {}};
  int epochs_before = 0;
  std::vector<LatticeState> counterexamples;
  RoundReporter reporter(options, watch);
  const bool chooses = score && options.correct;
  for (std::size_t round = 0; round < reporter.most() && !interrupted; ++round) {
    std::vector<Candidate> candidates;
    double next_look = kFirstLook;
    const int epochs = round == 0 ? options.epochs : options.repair_epochs;
    distiller.run(epochs, counterexamples, interrupted, [&](double done) {
      if (done < 1 && (!chooses || done < next_look)) return;
      next_look = done + (1 - kFirstLook) / kLooks;
      StudentNet net = quantise_student(distiller.parameters(), teacher.price_map, kSaturation);
      net.context = teacher.context;
      student.net = net;
      candidates.push_back({net, chooses ? score(student) : ValidationResult{},
                            epochs_before + static_cast<int>(std::lround(done * epochs))});
    });
    epochs_before += epochs;
    std::ranges::stable_sort(candidates, std::ranges::greater{}, &Candidate::score);
    if (candidates.empty()) break;  // interrupted
    const auto obedient = std::ranges::find_if(candidates, [&](const Candidate& candidate) {
      return check_corners(candidate.net, options, rules).counterexamples.empty();
    });
    const bool is_last = round + 1 == reporter.most();
    if (chooses) {
      note_checkpoints(candidates, static_cast<std::size_t>(obedient - candidates.begin()),
                       static_cast<int>(round) + 1, result.checkpoints);
    }
    if (obedient == candidates.end() && !is_last) {
      Certificate found = check_corners(candidates.front().net, options, rules);
      counterexamples = std::move(found.counterexamples);
      ProofRound corners = round_of(found);
      corners.is_whole = false;
      reporter.add(std::move(corners), result.rounds);
      continue;
    }
    const Candidate& taken = obedient == candidates.end() ? candidates.front() : *obedient;
    student.net = taken.net;
    if (chooses) note_cycles(taken.validation, student);
    result.verdict = judge(student, options);
    counterexamples = student_of(result.verdict).certificate.counterexamples;
    reporter.add(round_of(student_of(result.verdict).certificate), result.rounds);
    if (std::holds_alternative<ProvedStudent>(result.verdict)) break;
  }
  result.curve = distiller.curve();
  return result;
}

}  // namespace

StudentScore validation_score(const MarketSteps& market, const BatteryParameters& battery,
                              double initial_soc_frac) {
  return [&market, &battery, initial_soc_frac](const StudentFile& student) {
    StudentPolicy policy(student.net, student.outlook);
    const Evaluation validation = evaluate(market, market.days_of(Split::kValidation), policy,
                                           {battery, initial_soc_frac, true});
    return ValidationResult{validation.profit_eur_per_day_per_mwh(), validation.cycles_per_day()};
  };
}

CorrectionResult correct_and_prove(const Teacher& teacher, const Matrix& visited,
                                   const DistilOptions& given, const std::atomic<bool>& interrupted,
                                   const StudentScore& score, const RoundWatch& watch) {
  DistilOptions options = given;
  if (teacher.outlook) {
    if (options.method != CorrectionMethod::kConstruction) {
      fail("[distil] method = \"layer\" does not support the outlook: use \"construction\"");
    }
    options.rules = with_outlook_rule(given.rules);
  }
  require_consistent(options.rules, options.correction.thresholds, teacher.context.kind);
  StudentFile student{};
  student.certificate.rules = options.rules;
  student.certificate.thresholds = options.correction.thresholds;
  student.provenance = provenance_of(teacher, options);
  student.learnt_for = teacher.learnt_for;
  if (options.method == CorrectionMethod::kConstruction) {
    student.outlook = teacher.plan_cache;
    return construct_and_prove(teacher, visited, options, interrupted, score, watch, student);
  }
  Distiller distiller(teacher, visited, options);
  CorrectionResult result{.verdict = student, .curve = {}, .rounds = {}};
  double margin_scale = 1;
  int epochs_done = 0;
  RoundReporter reporter(options, watch);
  for (std::size_t round = 0; round < reporter.most() && !interrupted; ++round) {
    const int epochs = round == 0 ? options.epochs : options.repair_epochs;
    distiller.run(epochs, student_of(result.verdict).certificate.counterexamples, margin_scale,
                  interrupted);
    student.net = quantise_student(distiller.parameters(), teacher.price_map);
    student.net.context = teacher.context;
    epochs_done += epochs;
    const bool is_tried = score && options.correct;  // the last one is taken regardless of profit
    const ValidationResult validation = is_tried ? score(student) : ValidationResult{};
    if (is_tried) note_cycles(validation, student);
    result.verdict = judge(student, options);
    if (is_tried) {
      const bool is_proved = std::holds_alternative<ProvedStudent>(result.verdict);
      result.checkpoints.push_back(
          {static_cast<int>(round) + 1, epochs_done, validation.profit,
           is_proved ? CheckpointState::kChosen : CheckpointState::kDisobeys});
    }
    reporter.add(round_of(student_of(result.verdict).certificate), result.rounds);
    if (std::holds_alternative<ProvedStudent>(result.verdict)) break;
    margin_scale *= kMarginGrowth;
  }
  result.curve = distiller.curve();
  return result;
}

}  // namespace bess
