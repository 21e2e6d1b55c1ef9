// Exported student of this build, assembled at compile time from the C arrays of
// <student_weights.h>: weights of another architecture, damaged or unproved weights do not compile.
// Include in few files: each has its own tables.
#pragma once

#include <student_weights.h>

#include <algorithm>
#include <array>

#include "shared/decision_rule.h"
#include "shared/nn/student_net.h"
#include "shared/price_thresholds.h"
#include "shared/training_period.h"

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
#ifdef BESS_STUDENT_OUTLOOK_HASH
  net.context.kind = ContextKind::kOutlook;
#endif
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
              "student_weights.h has another format version: export it again");
static_assert(BESS_STUDENT_ARCHITECTURE_HASH == student_architecture_hash(),
              "student_weights.h was exported for another architecture: export it again");
static_assert(BESS_STUDENT_WEIGHTS_HASH == student_weights_hash(kExportedStudent),
              "student_weights.h is damaged or was edited by hand: export it again");

/// Thresholds of the proof. The thresholds of the guard may differ.
inline constexpr PriceThresholds kExportedThresholds{BESS_STUDENT_LOW_PRICE_EUR_PER_MWH,
                                                     BESS_STUDENT_HIGH_PRICE_EUR_PER_MWH};
static_assert(kExportedThresholds.are_ordered());
static_assert(kExportedStudent.context.is_valid());
inline constexpr std::int64_t kExportedViolations = BESS_STUDENT_VIOLATIONS_PROPERTY_1 +
                                                    BESS_STUDENT_VIOLATIONS_PROPERTY_2 +
                                                    BESS_STUDENT_VIOLATIONS_PROPERTY_3;
static_assert(BESS_STUDENT_STATES_CHECKED == kLatticeStateCount && kExportedViolations == 0,
              "student_weights.h is not proved over the whole lattice: export it again");

#ifndef BESS_STUDENT_TRAINED_UNTIL  // header of an earlier version
#define BESS_STUDENT_TRAINED_FROM ""
#define BESS_STUDENT_TRAINED_UNTIL ""
#endif
#ifndef BESS_STUDENT_CYCLES_PER_DAY_E2
#define BESS_STUDENT_CYCLES_PER_DAY_E2 -1
#endif
inline constexpr TrainingPeriod kExportedTraining{BESS_STUDENT_TRAINED_FROM,
                                                  BESS_STUDENT_TRAINED_UNTIL};
static_assert(kExportedTraining.is_sound(),
              "the training days of student_weights.h were edited by hand: export it again");

/// Operator rules of the guard; a header without rules has no table.
#ifdef BESS_STUDENT_GUARD_RULE_COUNT
inline constexpr int kExportedGuardRuleCount = BESS_STUDENT_GUARD_RULE_COUNT;
inline constexpr int kExportedRuleCheckCount = BESS_STUDENT_RULE_CHECK_COUNT;

namespace detail {
constexpr std::array<GuardRule, kExportedGuardRuleCount> assemble_exported_guard_rules() {
  std::array<GuardRule, kExportedGuardRuleCount> rules{};
  for (std::size_t r = 0; r < rules.size(); ++r)
    rules[r] = guard_rule_of(bess_student_guard_rule[r]);
  return rules;
}
}  // namespace detail

inline constexpr auto kExportedGuardRules = detail::assemble_exported_guard_rules();
static_assert(BESS_STUDENT_RULES_HASH == ruled_hash(BESS_STUDENT_WEIGHTS_HASH, kExportedGuardRules),
              "the rules of student_weights.h are damaged or were edited by hand: export it again");

constexpr const char* exported_guard_rule_name(int index) {
  return bess_student_guard_rule_name[index];
}

/// Number of golden points with other limits than at the exporter: must be 0.
constexpr int count_exported_rule_check_failures() {
  int failures = 0;
  for (int i = 0; i < kExportedRuleCheckCount; ++i) {
    const auto& p = bess_student_rule_check_point[i];
    const auto& limits = bess_student_rule_check_limits[i];
    const RulePoint point{p[0], static_cast<std::int16_t>(p[1]), static_cast<std::int16_t>(p[2]),
                          static_cast<std::int16_t>(p[3]), static_cast<std::int16_t>(p[4])};
    const RuleLimits expected{static_cast<ActionSet>(limits[0]), limits[1]};
    if (rule_limits_at(kExportedGuardRules, point) != expected) ++failures;
  }
  return failures;
}
#else
inline constexpr int kExportedGuardRuleCount = 0;
inline constexpr int kExportedRuleCheckCount = 0;
inline constexpr std::array<GuardRule, 0> kExportedGuardRules{};
constexpr const char* exported_guard_rule_name(int) { return ""; }
constexpr int count_exported_rule_check_failures() { return 0; }
#endif

/// Hash of net and rules.
inline constexpr std::uint32_t kExportedHash =
    ruled_hash(BESS_STUDENT_WEIGHTS_HASH, kExportedGuardRules);

inline constexpr int kExportedSelfCheckCount = BESS_STUDENT_SELF_CHECK_COUNT;
static_assert(kExportedSelfCheckCount > 0, "student_weights.h has no self-check vectors");

/// Number of self-check vectors, golden states with their logits, and rules with other results than
/// at the exporter: must be 0.
inline int count_exported_self_check_failures() {
  int failures = count_exported_rule_check_failures();
  for (int i = 0; i < kExportedSelfCheckCount; ++i) {
    const auto& s = bess_student_self_check_state[i];
    const LatticeState state{.minute_of_quarter_hour = s[0],
                             .quarter_hour = s[1],
                             .context_class = s[2],
                             .soc_index = s[3],
                             .price_eur_per_mwh = s[4]};
    std::int16_t x[kStudentInputs] = {};
    std::int32_t logits[kActionCount] = {};
    kExportedStudent.quantise(state, x);
    kExportedStudent.propagate(x, logits);
    if (!std::equal(logits, logits + kActionCount, bess_student_self_check_logits[i])) ++failures;
  }
  return failures;
}

}  // namespace bess
