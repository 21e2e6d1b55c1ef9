#include "workstation/student/correct_and_prove.h"

#include <fmt/core.h>

#include "workstation/student/quantise.h"

namespace bess {
namespace {

/// Each repair asks for slopes this much steeper than the last: rounding jitter is what is left.
constexpr double kMarginGrowth = 1.4;

std::string provenance_of(const Teacher& teacher, const DistilOptions& options) {
  return fmt::format("{}; {} omega {:g}, {} epochs, seed {}", teacher.provenance,
                     options.correct ? "corrected," : "plain,", options.omega, options.epochs,
                     options.seed);
}

}  // namespace

CorrectionResult correct_and_prove(const Teacher& teacher, const Matrix& visited,
                                   const DistilOptions& options,
                                   const std::atomic<bool>& interrupted) {
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
    result.verdict = prove(student, options.threads);
    result.violations_by_round.push_back(student_of(result.verdict).certificate.violations());
    if (std::holds_alternative<ProvedStudent>(result.verdict)) break;
    margin_scale *= kMarginGrowth;
  }
  result.curve = distiller.curve();
  return result;
}

}  // namespace bess
