#include "workstation/student/correct_and_prove.h"

#include <fmt/core.h>

#include <algorithm>

#include "workstation/correction/monotone_distil.h"
#include "workstation/env/evaluate.h"
#include "workstation/student/quantise.h"
#include "workstation/student/student_policy.h"

namespace bess {
namespace {

/// Each repair asks for slopes this much steeper than the last: rounding jitter is what is left.
constexpr double kMarginGrowth = 1.4;

std::string provenance_of(const Teacher& teacher, const DistilOptions& options) {
  if (options.method == CorrectionMethod::kConstruction) {
    return fmt::format("{}; {}, fidelity {:g}, {} epochs, seed {}", teacher.provenance,
                       options.correct ? "monotone by construction" : "plain", options.fidelity,
                       options.epochs, options.seed);
  }
  return fmt::format("{}; {} omega {:g}, {} epochs, seed {}", teacher.provenance,
                     options.correct ? "corrected," : "plain,", options.omega, options.epochs,
                     options.seed);
}

/// A student on the way, and what it earns on validation days.
struct Candidate {
  StudentNet net;
  double score;
};

/// Monotone by construction: the proof can only fail at the thresholds.
CorrectionResult construct_and_prove(const Teacher& teacher, const Matrix& visited,
                                     const DistilOptions& options,
                                     const std::atomic<bool>& interrupted,
                                     const StudentScore& score, StudentFile student) {
  constexpr double kFirstLook = 0.5;  ///< share of the epochs after which students are worth a look
  constexpr int kLooks = 16;
  constexpr std::size_t kProofsPerRound = 3;
  const LessonStates lessons = make_lessons(teacher, visited, options);
  MonotoneDistiller distiller(teacher, lessons, options);
  CorrectionResult result{.verdict = student, .curve = {}, .violations_by_round = {}};
  std::vector<LatticeState> counterexamples;
  const int rounds = options.correct ? 1 + options.repair_rounds : 1;
  for (int round = 0; round < rounds && !interrupted; ++round) {
    std::vector<Candidate> candidates;
    double next_look = kFirstLook;
    distiller.run(round == 0 ? options.epochs : options.repair_epochs, counterexamples, interrupted,
                  [&](double done) {
                    const bool is_last = done >= 1;
                    if (!is_last && (!score || !options.correct || done < next_look)) return;
                    next_look = done + (1 - kFirstLook) / kLooks;
                    StudentNet net =
                        quantise_student(distiller.parameters(), teacher.price_map, kSaturation);
                    net.context = teacher.context;
                    candidates.push_back({net, score && options.correct ? score(net) : 0.0});
                  });
    std::ranges::stable_sort(candidates, std::ranges::greater{}, &Candidate::score);
    for (std::size_t c = 0; c < std::min(kProofsPerRound, candidates.size()); ++c) {
      student.net = candidates[c].net;
      Verdict verdict = prove(student, options.threads);
      const bool proved = std::holds_alternative<ProvedStudent>(verdict);
      if (c == 0 || proved) result.verdict = std::move(verdict);
      if (proved) break;
    }
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
  if (options.method == CorrectionMethod::kConstruction) {
    StudentFile student{};
    student.certificate.thresholds = options.correction.thresholds;
    student.provenance = provenance_of(teacher, options);
    return construct_and_prove(teacher, visited, options, interrupted, score, student);
  }
  Distiller distiller(teacher, visited, options);
  StudentFile student{};
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
    result.verdict = prove(student, options.threads);
    result.violations_by_round.push_back(student_of(result.verdict).certificate.violations());
    if (std::holds_alternative<ProvedStudent>(result.verdict)) break;
    margin_scale *= kMarginGrowth;
  }
  result.curve = distiller.curve();
  return result;
}

}  // namespace bess
