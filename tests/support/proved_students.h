// Students with a short proof, and the claim of an unproved one.
#pragma once

#include "tests/support/student_nets.h"
#include "workstation/correction/student/prove.h"

namespace bess {

/// Claims of a file about itself.
inline Certificate flawless_claim() {
  return {.states_checked = kLatticeStateCount, .states_evaluated = 1};
}

/// A LinearNet among hidden units that hold numbers but do not change a difference of logits: every
/// array is distinguishable from every other, and bounds still prove it in few boxes.
inline StudentNet crowded_net() {
  StudentNet n = LinearNet{.price_weight = 2}.net();
  n.relu1.shift = 1;
  n.layer2.weight[0][0] = 4;
  n.relu2.shift = 2;
  const StudentNet seeded = seeded_net(31);
  for (int h = 1; h < kStudentHidden1; ++h) {
    for (int i = 0; i < kStudentInputs; ++i) n.layer1.weight[i][h] = seeded.layer1.weight[i][h];
    n.layer1.bias[h] = seeded.layer1.bias[h];
    for (int o = 1; o < kStudentHidden2; ++o) {
      n.layer2.weight[h][o] = static_cast<std::int16_t>(seeded.layer2.weight[h][o] / 64);
    }
  }
  for (int o = 1; o < kStudentHidden2; ++o) {
    n.layer2.bias[o] = seeded.layer2.bias[o] / 64;
    for (std::int16_t& w : n.layer3.weight[o]) w = static_cast<std::int16_t>(o);
  }
  return n;
}

inline constexpr PriceThresholds kCrowdedThresholds{-400, 1400};
inline constexpr const char* kCrowdedProvenance = "made by hand \"q\" ?";

inline StudentFile crowded_file(Certificate claim) {
  StudentFile student{crowded_net(), std::move(claim), kCrowdedProvenance};
  student.learnt_for = {{"prices", "crc32 78d15778, 442080 minutes from 2024-02-28T23:00:00Z"}};
  student.cycles_per_day = 3.21;
  return student;
}

/// Proved once for all tests of a program: the whole lattice takes seconds. It claims nothing
/// beforehand.
inline const ProvedStudent& crowded_student() {
  static const Verdict verdict = prove(crowded_file({.thresholds = kCrowdedThresholds,
                                                     .states_evaluated = 99,
                                                     .counts = {{}, {}, {true, 0, 1}, {}}}),
                                       2);
  return std::get<ProvedStudent>(verdict);
}

}  // namespace bess
