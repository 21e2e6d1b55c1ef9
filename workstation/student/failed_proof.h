// Why a proof failed, for whoever has to do something about it: each demand that is broken with its
// count, a state, what the student does there, and what to change.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "workstation/correction/distil.h"
#include "workstation/student/proof_rounds.h"
#include "workstation/student/student_file.h"

namespace bess {

struct BrokenDemand {
  DemandCount count;
  std::string example;  ///< the state and what is done there; empty when none is known
  std::string advice;   ///< what to change
  std::optional<LatticeState> state{};  ///< that of the example
};

/// Of a student with the certificate of its proof. Counterexamples help; without them the states
/// that decide a monotone student are searched.
std::vector<BrokenDemand> broken_demands(const StudentFile& student, CorrectionMethod method);

/// One line, and one below it for each broken demand, with its advice. `where` in front, `note`
/// behind the count.
std::string describe_failed_proof(const StudentFile& student, const std::vector<ProofRound>& rounds,
                                  CorrectionMethod method, const std::string& where = "",
                                  const std::string& note = "");

/// "context class 3, 22:15, minute 0, SoC 50 %, 1500 EUR/MWh".
std::string state_text(const LatticeState& state, ContextKind kind);

}  // namespace bess
