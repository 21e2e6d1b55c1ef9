// The prover, and the type that is its word. A ProvedStudent can be made here alone, and it alone
// can be exported (export.h): a weight header that says "proved" was proved by the program that
// wrote it. What a student's file says about itself is not believed.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "shared/features.h"
#include "workstation/correction/distillation/distil.h"
#include "workstation/correction/student/proof_rounds.h"
#include "workstation/correction/student/student_file.h"

namespace bess {

// Why a proof failed, for whoever has to do something about it: each demand that is broken with its
// count, a state, what the student does there, and what to change.

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

// States in which a student violates a property, as CSV: where a report looks, without another
// proof.

/// Header `minute_of_quarter_hour,quarter_hour,context_class,soc_index,price_eur_per_mwh`.
std::string counterexamples_csv(const std::vector<LatticeState>& states);
/// Reads it back; throws UserError naming `name` and the line.
std::vector<LatticeState> parse_counterexamples_csv(std::string_view text, const std::string& name);

class ProvedStudent;

/// What is left when the proof fails: the student, with its violations in the certificate.
using Verdict = std::variant<ProvedStudent, StudentFile>;

/// Checks every lattice state against the thresholds in the student's certificate, and replaces the
/// rest of that certificate by what it finds. `exhaustive` evaluates each state instead of proving
/// boxes by bounds. Throws UserError for a net that the bounds do not hold for (check_net).
Verdict prove(StudentFile student, int threads, bool exhaustive = false);

/// Counts violations in every kSampleStride-th context alone, an even share of all states: what a
/// student that nobody means to export needs. The certificate says how many states were looked at,
/// and proves nothing.
StudentFile sample_violations(StudentFile student, int threads);

/// Shares no factor with the counts of minutes, quarter-hours and classes: each of them is met.
inline constexpr int kSampleStride = 7;

/// A student that was checked on the whole lattice and violates no property there.
class ProvedStudent {
 public:
  [[nodiscard]] const StudentNet& net() const { return student_.net; }
  [[nodiscard]] const Certificate& certificate() const { return student_.certificate; }
  [[nodiscard]] const std::string& provenance() const { return student_.provenance; }
  [[nodiscard]] const StudentFile& file() const { return student_; }

 private:
  friend Verdict prove(StudentFile student, int threads, bool exhaustive);
  explicit ProvedStudent(StudentFile student) : student_(std::move(student)) {}

  StudentFile student_;
};

/// The student of either verdict, with the prover's certificate.
const StudentFile& student_of(const Verdict& verdict);

}  // namespace bess
