#include "workstation/student/correct_and_prove.h"

#include "workstation/student/quantise.h"

namespace bess {
namespace {
/// Each repair asks for slopes this much steeper than the last: rounding jitter is what is left.
constexpr double kMarginGrowth = 1.4;
}  // namespace

CorrectedStudent correct_and_prove(const Teacher& teacher, const Matrix& visited,
                                   const DistilOptions& options,
                                   const std::atomic<bool>& interrupted) {
  VerifyOptions proof;
  proof.low_price_eur_per_mwh = options.correction.low_price_eur_per_mwh;
  proof.high_price_eur_per_mwh = options.correction.high_price_eur_per_mwh;
  proof.threads = options.threads;
  Distiller distiller(teacher, visited, options);
  CorrectedStudent result{};
  double margin_scale = 1;
  const int rounds = options.correct ? 1 + options.repair_rounds : 1;
  for (int round = 0; round < rounds && !interrupted; ++round) {
    const int epochs = round == 0 ? options.epochs : options.repair_epochs;
    distiller.run(epochs, result.certificate.counterexamples, margin_scale, interrupted);
    result.net = quantise_student(distiller.parameters(), teacher.price_map);
    result.certificate = verify_student(result.net, proof);
    result.violations_by_round.push_back(result.certificate.violations());
    if (result.certificate.violations() == 0) break;
    margin_scale *= kMarginGrowth;
  }
  result.curve = distiller.curve();
  return result;
}

}  // namespace bess
