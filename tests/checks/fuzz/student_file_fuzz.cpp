// Student files: an accepted file has valid thresholds and evaluates without overflow in any state.
#include "shared/host/user_error.h"
#include "tests/checks/fuzz/fuzz_target.h"
#include "tests/support/integer_nets.h"
#include "workstation/correction/student/student_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bess;
  try {
    const StudentFile student = parse_student(std::string(text_of(data, size)), "fuzz");
    must(student.certificate.thresholds.are_ordered(), "ordered thresholds");
    Random random(1);
    for (int i = 0; i < 16; ++i) {
      const Action action = student.net.decide(random_lattice_state(random));
      must(action == Action::kDischarge || action == Action::kIdle || action == Action::kCharge,
           "an action");
    }
  } catch (const UserError&) {
  }
  return 0;
}
