// Correction rounds: remaining violations of each round by demand, as progress text and as CSV; and
// the checkpoints of a correction.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/correction/student/certificate.h"

namespace bess {

/// Violations of one property or rule.
struct DemandLeft {
  std::string label;
  std::int64_t violations = 0;
};

struct ProofRound {
  /// True: the whole lattice, or a sample of it. False: only the deciding states of a monotone
  /// student, which avoids a proof that would fail.
  bool is_whole = true;
  std::vector<DemandLeft> left;  ///< for every demand that binds the student

  [[nodiscard]] std::int64_t violations() const;
  /// "property 1: 3, rule \"quiet hours\": 23994"; empty without violations.
  [[nodiscard]] std::string text() const;
};

/// Counts of a proof or sample.
ProofRound round_of(const Certificate& certificate);

/// Progress of a correction after a round.
struct RoundsState {
  std::size_t done = 0;
  std::size_t most = 0;
  double seconds_left = 0;  ///< if all rounds are needed at the last one's duration
};
using RoundWatch = std::function<void(const ProofRound&, const RoundsState&)>;

/// "round 2 of at most 13: rule \"quiet hours\": 23994 left; at most 4 min more and a proof", for
/// RoundWatch.
std::string round_line(const ProofRound& round, const RoundsState& state);

/// Header `round,looked_at,demand,violations`, one row per round and demand; looked_at is "lattice"
/// or "corners".
std::string proof_rounds_csv(const std::vector<ProofRound>& rounds);
/// Parses it; throws UserError naming `name` and the line.
std::vector<ProofRound> parse_proof_rounds_csv(std::string_view text, const std::string& name);

// Checkpoints: the students checked, their validation results, and the chosen one.

enum class CheckpointState {
  kPassedOver,  ///< another one earned more
  kDisobeys,    ///< earned more than the chosen one but violates a demand
  kChosen,
};
std::string_view checkpoint_state_name(CheckpointState state);  ///< "passed over", ...

struct StudentCheckpoint {
  int round;  ///< from 1
  int epoch;  ///< over all rounds
  double validation_eur_per_day_per_mwh;
  CheckpointState state;
};

/// Header `round,epoch,validation_eur_per_day_per_mwh,state`.
std::string student_checkpoints_csv(const std::vector<StudentCheckpoint>& checkpoints);
/// Parses it; throws UserError naming `name` and the line.
std::vector<StudentCheckpoint> parse_student_checkpoints_csv(std::string_view text,
                                                             const std::string& name);

}  // namespace bess
