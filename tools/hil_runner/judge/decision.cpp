#include "tools/hil_runner/judge/bench.h"

#include "edge/control/policy.h"
#include "shared/features.h"

namespace bess {

/// The student of this build, asked again with the logged price and SoC, the level counted anew.
void judge_decision(Bench& bench) {
  PriceLevel level = bench.level;
  for (const CycleRecord& cycle : bench.evidence.log) {
    if (cycle.mode == Mode::kStopping) continue;
    if (cycle.price.has_row)
      level.observe(cycle.price.minute_utc_s, cycle.price.price_centi_eur_per_mwh);
    if (!cycle.has_student_action) continue;
    const LocalMinute now = local_minute_of(cycle.utc_s);
    const std::int32_t context_centi =
        student_outlook() != nullptr ? context_centi_of(cycle) : level.centi_eur_per_mwh();
    const std::int16_t context = student_context_class(now, context_centi);
    const Action action = decide_with_student(make_lattice_state(
        now, context, cycle.measurement.soc_e4, cycle.price.price_centi_eur_per_mwh));
    if (action != cycle.student_action || context != cycle.context_class) {
      bench.find(
          cycle.utc_s * kSecondNs, fmt::format("{} in class {}", action_name(action), context),
          fmt::format("{} in class {}", action_name(cycle.student_action), cycle.context_class));
    }
    const std::int32_t power_w = power_sign(action) * bench.config.control.guard.power_w;
    if (cycle.reason != Reason::kStudent || cycle.ordered_power_w == power_w) continue;
    bench.find(cycle.utc_s * kSecondNs, fmt::format("the student's {} W", power_w),
               fmt::format("{} W", cycle.ordered_power_w));
  }
}

}  // namespace bess
