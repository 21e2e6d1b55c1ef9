// The prover, and the type that is its word. A ProvedStudent can be made here alone, and it alone
// can be exported (export.h): a weight header that says "proved" was proved by the program that
// wrote it. What a student's file says about itself is not believed.
#pragma once

#include <variant>

#include "workstation/student/student_file.h"

namespace bess {

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
