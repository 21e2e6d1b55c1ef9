#include "edge/core/control/decision_signature.h"

#include "edge/core/control/policy.h"
#include "shared/local_time.h"

namespace bess {
namespace {

class GuardedStudent final : public ReplayedDecider {
 public:
  std::int32_t power_w(const ReplayedMoment& m) override {
    return guard_
        .decide(undisturbed_inputs(m.now_utc_s, m.soc_e4, m.context_centi, m.now_utc_s - 60,
                                   m.price_centi_eur_per_mwh))
        .power_w;
  }

 private:
  SafetyGuard guard_{{.power_w = kReplayedPowerW,
                      .soc_min_e4 = kReplayedSocMinE4,
                      .soc_max_e4 = kReplayedSocMaxE4,
                      .soc_hysteresis_e4 = kReplayedSocHysteresisE4}};
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
  GuardedStudent decider;
  return replay_recorded_days(decider, student_outlook());
}

}  // namespace bess
