#include "workstation/student/prove.h"

#include <numeric>

#include "workstation/student/verify.h"

namespace bess {

static_assert(std::gcd(kSampleStride, kContextCount) == 1);

Verdict prove(StudentFile student, int threads, bool exhaustive) {
  check_net(student.net, "the student");
  student.certificate = verify_student(student.net, {.thresholds = student.certificate.thresholds,
                                                     .rules = student.certificate.rules,
                                                     .exhaustive = exhaustive,
                                                     .threads = threads});
  if (!student.certificate.covers_lattice_without_violation()) return student;
  return ProvedStudent(std::move(student));
}

StudentFile sample_violations(StudentFile student, int threads) {
  check_net(student.net, "the student");
  student.certificate = verify_student(student.net, {.thresholds = student.certificate.thresholds,
                                                     .rules = student.certificate.rules,
                                                     .context_stride = kSampleStride,
                                                     .threads = threads});
  return student;
}

const StudentFile& student_of(const Verdict& verdict) {
  const auto* proved = std::get_if<ProvedStudent>(&verdict);
  return proved != nullptr ? proved->file() : std::get<StudentFile>(verdict);
}

}  // namespace bess
