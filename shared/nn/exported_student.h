// The student that this build carries: assembled at compile time from the exported plain C arrays
// of <student_weights.h>, so that weights of another architecture, damaged ones or unproved ones do
// not compile.
// Include this in few files: the tables are constant-initialised in each.
#pragma once

#include <student_weights.h>

#include "shared/nn/student_net.h"
#include "shared/price_thresholds.h"

namespace bess {

namespace detail {

template <int kInputs, int kOutputs>
constexpr void copy_layer(const std::int16_t (&weight)[kInputs][kOutputs],
                          const std::int32_t (&bias)[kOutputs], Affine<kInputs, kOutputs>& layer) {
  for (int i = 0; i < kInputs; ++i) {
    for (int o = 0; o < kOutputs; ++o) layer.weight[i][o] = weight[i][o];
  }
  for (int o = 0; o < kOutputs; ++o) layer.bias[o] = bias[o];
}

constexpr StudentNet assemble_exported_student() {
  StudentNet net{};
  net.context.kind = BESS_STUDENT_CONTEXT_IS_LEVEL ? ContextKind::kLevel : ContextKind::kMonth;
  for (int c = 0; c + 1 < kContextClassCount; ++c) {
    net.context.level_edge_eur_per_mwh[c] = bess_student_level_edge_eur_per_mwh[c];
  }
  for (int p = 0; p < kPriceCount; ++p) net.price_map[p] = bess_student_price_map[p];
  copy_layer(bess_student_layer1_weight, bess_student_layer1_bias, net.layer1);
  net.relu1.shift = bess_student_relu1_shift;
  copy_layer(bess_student_layer2_weight, bess_student_layer2_bias, net.layer2);
  net.relu2.shift = bess_student_relu2_shift;
  copy_layer(bess_student_layer3_weight, bess_student_layer3_bias, net.layer3);
  return net;
}

}  // namespace detail

inline constexpr StudentNet kExportedStudent = detail::assemble_exported_student();

static_assert(BESS_STUDENT_VERSION == 3,
              "student_weights.h is of another format version: export it again");
static_assert(BESS_STUDENT_ARCHITECTURE_HASH == student_architecture_hash(),
              "student_weights.h was exported for another architecture: export it again");
static_assert(BESS_STUDENT_WEIGHTS_HASH == student_weights_hash(kExportedStudent),
              "student_weights.h is damaged or was edited by hand: export it again");

/// What the net was proved for. The guard's thresholds are the operator's and may be others.
inline constexpr PriceThresholds kExportedThresholds{BESS_STUDENT_LOW_PRICE_EUR_PER_MWH,
                                                     BESS_STUDENT_HIGH_PRICE_EUR_PER_MWH};
static_assert(kExportedThresholds.are_ordered());
static_assert(kExportedStudent.context.is_valid());
static_assert(BESS_STUDENT_STATES_CHECKED == kLatticeStateCount &&
                  BESS_STUDENT_VIOLATIONS_PROPERTY_1 == 0 &&
                  BESS_STUDENT_VIOLATIONS_PROPERTY_2 == 0 &&
                  BESS_STUDENT_VIOLATIONS_PROPERTY_3 == 0,
              "student_weights.h is not proved over the whole lattice: export it again");

inline constexpr int kExportedSelfCheckCount = BESS_STUDENT_SELF_CHECK_COUNT;
static_assert(kExportedSelfCheckCount > 0, "student_weights.h carries no self-check vectors");

/// Golden vector `index` of the header: a state and the logits that the exporter computed for it.
constexpr StudentSelfCheck exported_self_check(int index) {
  const auto& s = bess_student_self_check_state[index];
  const auto& z = bess_student_self_check_logits[index];
  return {.state = {.minute_of_quarter_hour = s[0],
                    .quarter_hour = s[1],
                    .context_class = s[2],
                    .soc_index = s[3],
                    .price_eur_per_mwh = s[4]},
          .logits = {z[0], z[1], z[2]}};
}

/// Number of self-check vectors that this machine answers differently from the exporter: must be 0.
inline int count_exported_self_check_failures() {
  int failures = 0;
  for (int i = 0; i < kExportedSelfCheckCount; ++i) {
    const StudentSelfCheck check = exported_self_check(i);
    std::int16_t x[kStudentInputs] = {};
    std::int32_t logits[kActionCount] = {};
    kExportedStudent.quantise(check.state, x);
    kExportedStudent.propagate(x, logits);
    for (int a = 0; a < kActionCount; ++a) {
      if (logits[a] != check.logits[a]) {
        ++failures;
        break;
      }
    }
  }
  return failures;
}

}  // namespace bess
