// The whole correction: distil, inside sign bounds or through the layer, quantise, prove over the
// whole lattice; while the proof finds violations, train on them as counterexamples (through the
// layer: with wider slope margins), and prove again.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "workstation/correction/distillation/distil.h"
#include "workstation/correction/student/proof_rounds.h"
#include "workstation/correction/student/prove.h"
#include "workstation/correction/student/student_checkpoints.h"

namespace bess {

struct CorrectionResult {
  Verdict verdict;  ///< of the last round: a proved student, or the one with what is left
  std::vector<DistilPoint> curve;
  std::vector<ProofRound> rounds;  ///< empty when interrupted before the first proof
  std::vector<StudentCheckpoint> checkpoints = {};  ///< in time; empty where nothing was scored
};

/// What a student earns on validation days, EUR per day per MWh, and its full cycles a day.
struct ValidationTrial {
  double profit, cycles_per_day;
};
using StudentScore = std::function<ValidationTrial(const StudentFile&)>;

/// Never throws for a failed proof: the verdict says it. With options.correct false there is one
/// round, no repair and no proof: violations are counted in a sample of the contexts. By
/// construction the best by `score` is taken of the students on the way that are proved; without
/// it, and through the layer, the last one. `watch` is told of each round.
CorrectionResult correct_and_prove(const Teacher& teacher, const Matrix& visited,
                                   const DistilOptions& options,
                                   const std::atomic<bool>& interrupted,
                                   const StudentScore& score = {}, const RoundWatch& watch = {});

/// Profit on the validation days of `market`, SoC carried over: a day that begins anew flatters a
/// student that empties the battery every night.
StudentScore validation_score(const MarketSteps& market, const BatteryParameters& battery,
                              double initial_soc_frac);

}  // namespace bess
