#include "workstation/student/correct_and_prove.h"

#include <fmt/core.h>

#include <algorithm>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/correction/monotone_distil.h"
#include "workstation/env/evaluate.h"
#include "workstation/student/quantise.h"
#include "workstation/student/student_policy.h"
#include "workstation/student/verify.h"

namespace bess {
namespace {

/// Each repair asks for slopes this much steeper than the last: rounding jitter is what is left.
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

/// A plain student is there to be compared with: its violations are sampled, not proved away.
Verdict judge(StudentFile student, const DistilOptions& options) {
  if (options.correct) return prove(std::move(student), options.threads);
  return sample_violations(std::move(student), options.threads);
}

/// A student on the way, and what it earns on validation days.
struct Candidate {
  StudentNet net;
  double score;
};

/// Contexts in which a monotone student disobeys a threshold or a rule: one state of each tells, the low price
/// at the highest SoC, the high price at the lowest, the corners of a rule's box. Quick, where a proof takes
/// seconds.
std::vector<LatticeState> disobedient_states(const StudentNet& net,
                                             const PriceThresholds& thresholds,
                                             const RuleLessons& rules) {
  std::vector<LatticeState> found;
  std::vector<HardState> corners;
  const auto require = [&](LatticeState state, int soc_index, int price, Action action) {
    state.soc_index = static_cast<std::int16_t>(soc_index);
    state.price_eur_per_mwh = static_cast<std::int16_t>(price);
    if (net.decide(state) != action) found.push_back(state);
  };
  const auto low = std::min(thresholds.low_eur_per_mwh, kLatticePriceMaxEurPerMwh);
  const auto high = std::max(thresholds.high_eur_per_mwh, kLatticePriceMinEurPerMwh);
  for (int c = 0; c < kContextCount; ++c) {
    const LatticeState context = context_at(c);
    if (thresholds.low_binds_student()) require(context, kSocCount - 1, low, Action::kCharge);
    if (thresholds.high_binds_student()) require(context, 0, high, Action::kDischarge);
    rules.corners(context, corners);
    for (const HardState& corner : corners) {
      if (!allows(corner.actions, net.decide(corner.state))) found.push_back(corner.state);
    }
  }
  return found;
}

/// Monotone by construction: the proof can only fail at the thresholds.
CorrectionResult construct_and_prove(const Teacher& teacher, const Matrix& visited,
                                     const DistilOptions& options,
                                     const std::atomic<bool>& interrupted,
                                     const StudentScore& score, StudentFile student) {
  constexpr double kFirstLook = 0.5;  ///< share of the epochs after which students are worth a look
  constexpr int kLooks = 16;
  const LessonStates lessons = make_lessons(teacher, visited, options);
  MonotoneDistiller distiller(teacher, lessons, options);
  const RuleLessons rules(options.rules, teacher.context.kind);
  CorrectionResult result{.verdict = student, .curve = {}, .violations_by_round = {}};
  std::vector<LatticeState> counterexamples;
  const int rounds = options.correct ? 1 + options.repair_rounds : 1;
  const bool chooses = score && options.correct;
  for (int round = 0; round < rounds && !interrupted; ++round) {
    std::vector<Candidate> candidates;
    double next_look = kFirstLook;
    distiller.run(round == 0 ? options.epochs : options.repair_epochs, counterexamples, interrupted,
                  [&](double done) {
                    if (done < 1 && (!chooses || done < next_look)) return;
                    next_look = done + (1 - kFirstLook) / kLooks;
                    StudentNet net =
                        quantise_student(distiller.parameters(), teacher.price_map, kSaturation);
                    net.context = teacher.context;
                    candidates.push_back({net, chooses ? score(net) : 0.0});
                  });
    std::ranges::stable_sort(candidates, std::ranges::greater{}, &Candidate::score);
    if (candidates.empty()) break;  // interrupted
    const auto obedient = std::ranges::find_if(candidates, [&](const Candidate& candidate) {
      return disobedient_states(candidate.net, options.correction.thresholds, rules).empty();
    });
    const bool is_last = round + 1 == rounds;
    if (obedient == candidates.end() && !is_last) {
      counterexamples =
          disobedient_states(candidates.front().net, options.correction.thresholds, rules);
      result.violations_by_round.push_back(static_cast<std::int64_t>(counterexamples.size()));
      continue;
    }
    student.net = (obedient == candidates.end() ? candidates.front() : *obedient).net;
    result.verdict = judge(student, options);
    counterexamples = student_of(result.verdict).certificate.counterexamples;
    result.violations_by_round.push_back(student_of(result.verdict).certificate.violations());
    if (std::holds_alternative<ProvedStudent>(result.verdict)) break;
  }
  result.curve = distiller.curve();
  return result;
}

}  // namespace

std::string_view mend_of_failed_proof(CorrectionMethod method) {
  return method == CorrectionMethod::kConstruction
             ? "raise [distil] epochs or repair_rounds, or move the thresholds of [correction] "
               "apart"
             : "raise [correction] price_slope and soc_slope or [distil] repair_rounds";
}

StudentScore validation_score(const MarketSteps& market, const BatteryParameters& battery,
                              double initial_soc_frac) {
  return [&market, &battery, initial_soc_frac](const StudentNet& net) {
    StudentPolicy policy(net);
    return evaluate(market, market.days_of(Split::kValidation), policy,
                    {battery, initial_soc_frac, true})
        .profit_eur_per_day_per_mwh();
  };
}

CorrectionResult correct_and_prove(const Teacher& teacher, const Matrix& visited,
                                   const DistilOptions& options,
                                   const std::atomic<bool>& interrupted,
                                   const StudentScore& score) {
  require_consistent(options.rules, options.correction.thresholds, teacher.context.kind);
  if (options.method == CorrectionMethod::kConstruction) {
    StudentFile student{};
    student.certificate.rules = options.rules;
    student.certificate.thresholds = options.correction.thresholds;
    student.provenance = provenance_of(teacher, options);
    return construct_and_prove(teacher, visited, options, interrupted, score, student);
  }
  Distiller distiller(teacher, visited, options);
  StudentFile student{};
  student.certificate.rules = options.rules;
  student.certificate.thresholds = options.correction.thresholds;
  student.provenance = provenance_of(teacher, options);
  CorrectionResult result{.verdict = student, .curve = {}, .violations_by_round = {}};
  double margin_scale = 1;
  const int rounds = options.correct ? 1 + options.repair_rounds : 1;
  for (int round = 0; round < rounds && !interrupted; ++round) {
    const int epochs = round == 0 ? options.epochs : options.repair_epochs;
    distiller.run(epochs, student_of(result.verdict).certificate.counterexamples, margin_scale,
                  interrupted);
    student.net = quantise_student(distiller.parameters(), teacher.price_map);
    student.net.context = teacher.context;
    result.verdict = judge(student, options);
    result.violations_by_round.push_back(student_of(result.verdict).certificate.violations());
    if (std::holds_alternative<ProvedStudent>(result.verdict)) break;
    margin_scale *= kMarginGrowth;
  }
  result.curve = distiller.curve();
  return result;
}

}  // namespace bess
