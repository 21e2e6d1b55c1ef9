// Prover and proof type. Only this code can make a ProvedStudent, and only a ProvedStudent can be
// exported (export.h): a weight header that says "proved" was proved by the program that wrote it.
// The certificate in a student's file is not trusted.
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
