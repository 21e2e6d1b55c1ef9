// Prover and proof type. Only this code can make a ProvedStudent, and only a ProvedStudent can be
// exported (export.h): a weight header that says "proved" was proved by the program that wrote it.
// The certificate in a student's file is not trusted.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "shared/features.h"
#include "workstation/correction/distillation/distil.h"
#include "workstation/correction/student/student_file.h"

namespace bess {

// Correction rounds: remaining violations of each round by demand, as progress text and as CSV; and
// the checkpoints of a correction.

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

// Explanation of a failed proof: each violated demand with its count, an example state, the
// student's action there, and a remedy.

struct BrokenDemand {
  DemandCount count;
  std::string example;                  ///< state and action; empty if unknown
  std::string advice;                   ///< what to change
  std::optional<LatticeState> state{};  ///< of the example
};

/// For a student with the certificate of its proof. Without counterexamples the deciding states of
/// a monotone student are searched.
std::vector<BrokenDemand> broken_demands(const StudentFile& student, CorrectionMethod method);

/// One line, then one line with a remedy per violated demand. `where` precedes the text, `note`
/// follows the count.
std::string describe_failed_proof(const StudentFile& student, const std::vector<ProofRound>& rounds,
                                  CorrectionMethod method, const std::string& where = "",
                                  const std::string& note = "");

/// "context class 3, 22:15, minute 0, SoC 50 %, 1500 EUR/MWh".
std::string state_text(const LatticeState& state, ContextKind kind);

// Counterexamples as CSV, for reports without another proof.

/// Header `minute_of_quarter_hour,quarter_hour,context_class,soc_index,price_eur_per_mwh`.
std::string counterexamples_csv(const std::vector<LatticeState>& states);
/// Parses it; throws UserError naming `name` and the line.
std::vector<LatticeState> parse_counterexamples_csv(std::string_view text, const std::string& name);

class ProvedStudent;

/// The StudentFile of a failed proof has its violations in the certificate.
using Verdict = std::variant<ProvedStudent, StudentFile>;

/// Checks every lattice state against the thresholds in the student's certificate and replaces the
/// rest of that certificate. `exhaustive` evaluates each state instead of proving boxes by bounds.
/// Throws UserError if the bounds are not valid for the net (check_net).
Verdict prove(StudentFile student, int threads, bool exhaustive = false);

/// Counts violations in every kSampleStride-th context, an even share of all states, for students
/// that are not exported. The certificate states the number of checked states and proves nothing.
StudentFile sample_violations(StudentFile student, int threads);

/// Coprime with the numbers of minutes, quarter-hours and classes, so that all of them occur.
inline constexpr int kSampleStride = 7;

/// A student without violations on the whole lattice.
class ProvedStudent {
 public:
  [[nodiscard]] const StudentFile& file() const { return student_; }

 private:
  friend Verdict prove(StudentFile student, int threads, bool exhaustive);
  explicit ProvedStudent(StudentFile student) : student_(std::move(student)) {}

  StudentFile student_;
};

/// The student of either verdict, with the prover's certificate.
const StudentFile& student_of(const Verdict& verdict);

}  // namespace bess
