// Benchmarks of the integer student: one decision, and the proof over the whole lattice.
#include "shared/nn/exported_student.h"
#include "tests/bench/registry.h"
#include "workstation/base/random.h"
#include "workstation/correction/distillation/distil.h"
#include "workstation/correction/student/prove.h"

namespace bess {
namespace {

std::vector<LatticeState> random_states() {
  Random random(1);
  std::vector<LatticeState> states(1024);
  for (LatticeState& s : states) {
    s = {static_cast<std::int16_t>(random.index(kMinuteOfQuarterHourCount)),
         static_cast<std::int16_t>(random.index(kQuarterHourCount)),
         static_cast<std::int16_t>(1 + random.index(kContextClassCount)),
         static_cast<std::int16_t>(random.index(kSocCount)),
         static_cast<std::int16_t>(kLatticePriceMinEurPerMwh +
                                   static_cast<int>(random.index(kPriceCount)))};
  }
  return states;
}

void integer_student(benchmark::State& state) {
  const std::vector<LatticeState> states = random_states();
  std::size_t at = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(kExportedStudent.decide(states[at]));
    at = (at + 1) % states.size();
  }
}

/// The same shape in float through Eigen, one sample at a time.
void float_student(benchmark::State& state) {
  const Parameters parameters = initial_parameters(kStudentShape, 1);
  const ConstMlp mlp(kStudentShape, parameters.data());
  Matrix x = Matrix::Random(kStudentInputs, 1);
  MlpTile tile;
  Matrix z;
  for (auto _ : state) {
    forward_hidden(mlp, x, tile);
    forward_head(mlp, tile, z);
    benchmark::DoNotOptimize(z.data());
    benchmark::ClobberMemory();
  }
}

}  // namespace

void register_student_benchmarks() {
  constexpr int kRepetitions = 5;
  add_benchmark("student-inference", benchmark::kNanosecond, kRepetitions, integer_student);
  add_benchmark("student-inference@eigen-float", benchmark::kNanosecond, kRepetitions,
                float_student);
  add_benchmark("verify-lattice", benchmark::kSecond, 1, [](benchmark::State& state) {
    const StudentFile student = compiled_student();
    for (auto _ : state) benchmark::DoNotOptimize(prove(student, 2));
  });
}

}  // namespace bess
