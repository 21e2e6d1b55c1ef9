#include "edge/control/decision_signature.h"

#include "edge/control/policy.h"
#include "edge/control/recorded_prices.h"
#include "shared/fixed_point.h"
#include "shared/local_time.h"
#include "shared/outlook/outlook_check.h"
#include "shared/price_level.h"
#include "shared/signature.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

/// The paper's house battery in whole watt-seconds, with 90 % of the energy left after a round
/// trip.
class IntegerBattery {
 public:
  [[nodiscard]] std::int32_t soc_e4() const {
    return static_cast<std::int32_t>(stored_ws_ * kSocFullE4 / kCapacityWs);
  }
  void exchange(std::int32_t power_w) {
    const std::int64_t energy_ws = std::int64_t{power_w} * kSecondsPerStep;
    stored_ws_ += energy_ws > 0 ? energy_ws * kOneWayE4 / 10'000 : energy_ws * 10'000 / kOneWayE4;
    stored_ws_ = clamp_to<std::int64_t>(stored_ws_, kCapacityWs / 10, kCapacityWs);
  }

 private:
  static constexpr std::int64_t kCapacityWs = 8'000 * 3'600;
  static constexpr std::int64_t kOneWayE4 = 9'487;
  std::int64_t stored_ws_ = kCapacityWs / 2;
};

/// Two days from here on hold the change of the clock in March and in October.
std::int64_t first_midnight_utc_s(int month) {
  const int day = month == 3 ? 25 : month == 10 ? 28 : 15;
  return utc_from_civil(
             {.year = 2023, .month = month, .day = day, .hour = 0, .minute = 0, .second = 0}) -
         3'600;
}

/// Level, or what a day's plan says; one a day, at the level of its first decision.
class RecordedContext {
 public:
  std::int32_t centi(std::int64_t utc_s, std::int32_t soc_e4, const PriceLevel& level) {
    const OutlookModel* const model = student_outlook();
    const std::int32_t level_centi = level.centi_eur_per_mwh();
    if (model == nullptr) return level_centi;
    static OutlookPlan plan;  // too large for the stack
    if (!is_made_ || !plan.serves(utc_s)) {
      plan.make(*model, made_up_outlook_days(utc_s), planned_level_centi(level_centi));
    }
    is_made_ = true;
    return plan.break_even_centi(*model, utc_s, soc_e4, level_centi);
  }

 private:
  bool is_made_ = false;
};

}  // namespace

GuardInputs undisturbed_inputs(std::int64_t now_utc_s, std::int32_t soc_e4,
                               std::int32_t context_centi, std::int64_t price_minute_utc_s,
                               std::int32_t price_centi_eur_per_mwh) {
  GuardInputs in;
  in.now_utc_s = now_utc_s;
  in.clock_ok = in.link_ok = in.has_price = true;
  in.measurement.soc_e4 = soc_e4;
  in.price_minute_utc_s = price_minute_utc_s;
  in.price_centi_eur_per_mwh = price_centi_eur_per_mwh;
  const LocalMinute now = local_minute_of(now_utc_s);
  const LatticeState state = make_lattice_state(now, student_context_class(now, context_centi),
                                                soc_e4, price_centi_eur_per_mwh);
  in.student_action = decide_with_student(state);
  in.rules = student_rule_limits(now, state, price_centi_eur_per_mwh);
  return in;
}

DecisionSignature replay_recorded_days() {
  SafetyGuard guard{GuardSettings{}};
  IntegerBattery battery;
  PriceLevel level;
  RecordedContext context;
  Signature signature;
  DecisionSignature result;
  for (int month = 1; month <= 12; ++month) {
    std::int64_t now_utc_s = first_midnight_utc_s(month);
    for (const std::int32_t price : kRecordedPricesCentiEurPerMwh) {
      level.observe(now_utc_s - 60, price);
      const GuardInputs in = undisturbed_inputs(now_utc_s, battery.soc_e4(),
                                                context.centi(now_utc_s, battery.soc_e4(), level),
                                                now_utc_s - 60, price);
      const std::int32_t power_w = guard.decide(in).power_w;
      battery.exchange(power_w);
      signature.add(now_utc_s);
      signature.add(power_w);
      ++result.decisions;
      result.charging += power_w > 0 ? 1 : 0;
      result.discharging += power_w < 0 ? 1 : 0;
      now_utc_s += kSecondsPerStep;
    }
  }
  result.signature = signature.value();
  return result;
}

}  // namespace bess
