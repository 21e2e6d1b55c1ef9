// Correction: distil (with sign bounds or through the layer), quantise, prove over the whole
// lattice; while the proof finds violations, train on them as counterexamples (layer: with wider
// slope margins) and repeat.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "workstation/correction/distillation/distil.h"
#include "workstation/correction/student/prove.h"

namespace bess {

struct CorrectionResult {
  Verdict verdict;  ///< of the last round: proved, or with the remaining violations
  std::vector<DistilPoint> curve;
  std::vector<ProofRound> rounds;  ///< empty when interrupted before the first proof
  std::vector<StudentCheckpoint> checkpoints = {};  ///< by time; empty without scores
};

/// Validation result of a student: profit, EUR per day per MWh, and full cycles per day.
struct ValidationResult {
  double profit, cycles_per_day;
};
using StudentScore = std::function<ValidationResult(const StudentFile&)>;

/// A failed proof does not throw: see the verdict. With options.correct false there is one round
/// without repair and proof: violations are counted in a sample of the contexts. Method
/// construction takes the proved student with the best `score`; without a score, and with the
/// layer, the last one. `watch` receives each round.
CorrectionResult correct_and_prove(const Teacher& teacher, const Matrix& visited,
                                   const DistilOptions& options,
                                   const std::atomic<bool>& interrupted,
                                   const StudentScore& score = {}, const RoundWatch& watch = {});

/// Profit on the validation days of `market`, SoC carried over: a daily reset would favour a
/// student that empties the battery every night.
StudentScore validation_score(const MarketSteps& market, const BatteryParameters& battery,
                              double initial_soc_frac);

}  // namespace bess
