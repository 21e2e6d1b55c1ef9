#include "tools/hil_runner/judge/bench.h"

#include <cmath>

#include "edge/control/policy.h"
#include "shared/features.h"

namespace bess {

namespace {

/// An exponential towards the level, with a time constant of an hour.
void judge_stand_in(const CycleRecord& cycle, const PriceLevel& level, Bench& bench) {
  if (!cycle.price_stands_in) return;
  const double level_centi = level.centi_eur_per_mwh();
  const double age_s = static_cast<double>(price_age_s(cycle.utc_s, cycle.price.minute_utc_s));
  const double distance_centi = cycle.price.price_centi_eur_per_mwh - level_centi;
  const double expected_centi = level_centi + distance_centi * std::exp(-age_s / 3'600);
  const double off_centi = std::abs(expected_centi - cycle.stand_in_centi_eur_per_mwh);
  if (off_centi <= 100 + 0.05 * std::abs(distance_centi)) return;
  bench.find(cycle.utc_s * kSecondNs, fmt::format("{:.2f} EUR/MWh stands in", expected_centi / 100),
             fmt::format("{:.2f}", cycle.stand_in_centi_eur_per_mwh / 100.0));
}

}  // namespace

/// The student of this build, asked again with the logged price and SoC, the level counted anew.
void judge_decision(Bench& bench) {
  PriceLevel level = bench.level;
  for (const CycleRecord& cycle : bench.evidence.log) {
    if (cycle.mode == Mode::kStopping) continue;
    if (cycle.price.has_row)
      level.observe(cycle.price.minute_utc_s, cycle.price.price_centi_eur_per_mwh);
    if (!cycle.has_student_action) continue;
    judge_stand_in(cycle, level, bench);
    const LocalMinute now = local_minute_of(cycle.utc_s);
    const std::int32_t context_centi =
        student_outlook() != nullptr ? context_centi_of(cycle) : level.centi_eur_per_mwh();
    const std::int16_t context = student_context_class(now, context_centi);
    const Action action = decide_with_student(
        make_lattice_state(now, context, cycle.measurement.soc_e4, decided_price_centi(cycle)));
    if (action != cycle.student_action || context != cycle.context_class) {
      bench.find(
          cycle.utc_s * kSecondNs, fmt::format("{} in class {}", action_name(action), context),
          fmt::format("{} in class {}", action_name(cycle.student_action), cycle.context_class));
    }
    const std::int32_t power_w = power_sign(action) * bench.config.control.guard.power_w;
    const bool is_students = cycle.reason == Reason::kStudent || cycle.reason == Reason::kStandIn;
    if (!is_students || cycle.ordered_power_w == power_w) continue;
    bench.find(cycle.utc_s * kSecondNs, fmt::format("the student's {} W", power_w),
               fmt::format("{} W", cycle.ordered_power_w));
  }
}

}  // namespace bess
