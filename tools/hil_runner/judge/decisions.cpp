#include <algorithm>
#include <cmath>
#include <memory>

#include "edge/core/control/cycle_budget.h"
#include "edge/core/control/policy.h"
#include "edge/core/control/reserve.h"
#include "shared/features.h"
#include "shared/local_time.h"
#include "shared/outlook/outlook_plan.h"
#include "shared/utc_text.h"
#include "tools/hil_runner/judge/judge_context.h"

namespace bess {

namespace {

/// Exponential decay towards the price level, time constant one hour.
void judge_stand_in(const CycleRecord& cycle, const PriceLevel& level, JudgeContext& judging) {
  if (!cycle.price_stands_in) return;
  const double level_centi = level.centi_eur_per_mwh();
  const double age_s = static_cast<double>(price_age_s(cycle.utc_s, cycle.price.minute_utc_s));
  const double distance_centi = cycle.price.price_centi_eur_per_mwh - level_centi;
  const double expected_centi = level_centi + distance_centi * std::exp(-age_s / 3'600);
  const double off_centi = std::abs(expected_centi - cycle.stand_in_centi_eur_per_mwh);
  if (off_centi <= 100 + 0.05 * std::abs(distance_centi)) return;
  judging.find(cycle.utc_s * kSecondNs,
               fmt::format("a stand-in price of {:.2f} EUR/MWh", expected_centi / 100),
               fmt::format("{:.2f}", cycle.stand_in_centi_eur_per_mwh / 100.0));
}

}  // namespace

/// Recomputes each decision with the student of this build, the logged price and SoC, and the
/// level.
void judge_decision(JudgeContext& judging) {
  PriceLevel level = judging.level;
  for (const CycleRecord& cycle : judging.evidence.log) {
    if (cycle.mode == Mode::kStopping) continue;
    if (cycle.price.has_row)
      level.observe(cycle.price.minute_utc_s, cycle.price.price_centi_eur_per_mwh);
    if (!cycle.has_student_action) continue;
    judge_stand_in(cycle, level, judging);
    const LocalMinute now = local_minute_of(cycle.utc_s);
    const std::int32_t context_centi =
        student_outlook() != nullptr ? context_centi_of(cycle) : level.centi_eur_per_mwh();
    const std::int16_t context = student_context_class(now, context_centi);
    const Action action = decide_with_student(
        make_lattice_state(now, context, cycle.measurement.soc_e4, decided_price_centi(cycle)));
    if (action != cycle.student_action || context != cycle.context_class) {
      judging.find(
          cycle.utc_s * kSecondNs, fmt::format("{} in class {}", action_name(action), context),
          fmt::format("{} in class {}", action_name(cycle.student_action), cycle.context_class));
    }
    const std::int32_t power_w = power_sign(action) * judging.config.control.guard.power_w;
    const bool is_students = cycle.reason == Reason::kStudent || cycle.reason == Reason::kStandIn;
    if (!is_students || cycle.ordered_power_w == power_w) continue;
    judging.find(cycle.utc_s * kSecondNs, fmt::format("the student's {} W", power_w),
                 fmt::format("{} W", cycle.ordered_power_w));
  }
}

void judge_inputs(JudgeContext& judging) {
  constexpr double kSocToleranceE4 =
      100;  // 1 %: resolution of registers, and energy since the reading
  for (const CycleRecord& cycle : judging.evidence.log) {
    if (cycle.mode == Mode::kStopping) continue;
    const std::int64_t tick_ns = cycle.utc_s * kSecondNs;
    if (cycle.price.has_row) {
      const auto price = judging.publication.price_of(cycle.price.minute_utc_s);
      const double seen = cycle.price.price_centi_eur_per_mwh / 100.0;
      if (!price || std::abs(*price - seen) > 0.0051) {
        judging.find(
            tick_ns,
            fmt::format("{} for {}", price ? fmt::format("{:.2f} EUR/MWh", *price) : "no price",
                        utc_text(cycle.price.minute_utc_s).view()),
            fmt::format("{:.2f}", seen));
      }
    }
    if (!cycle.has_measurement || judging.is_disturbed(tick_ns)) continue;
    const double soc_e4 = 1e4 * judging.soc_at(tick_ns);
    const double flow_e4 = 1e4 * judging.scenario.battery.physics.power_w_max *
                           (60 + judging.evidence.slack_s) / 3'600 /
                           judging.scenario.battery.physics.capacity_wh;
    if (std::abs(soc_e4 - cycle.measurement.soc_e4) <= kSocToleranceE4 + flow_e4) continue;
    judging.find(tick_ns, fmt::format("a SoC near {:.4f}", soc_e4 / 1e4),
                 fmt::format("{:.4f}", cycle.measurement.soc_e4 / 1e4));
  }
}

void judge_fresh_price(JudgeContext& judging) {
  judging.each_tick([&](std::int64_t tick_ns) {
    const auto fresh = judging.fresh_row(tick_ns);
    if ((fresh && !judging.must_be_frozen(*fresh)) || judging.is_disturbed_in_cycle(tick_ns))
      return;
    if (!fresh && judging.may_stand_in(tick_ns)) return;
    const CommandInForce command = judging.command_at(judging.settled_ns(tick_ns));
    if (command.power_w == 0) return;
    const auto row = judging.publication.newest(tick_ns);
    judging.find(
        judging.settled_ns(tick_ns),
        row ? fmt::format("0 W, the newest price is of {}", utc_text(row->minute_utc_s).view())
            : "0 W, there is no price",
        watts(command));
  });
}

namespace {

struct RecomputedPlan {
  OutlookPlan plan;
  OutlookDays days;
  std::int32_t level_centi = INT32_MIN;

  std::int32_t break_even_centi(const CycleRecord& cycle, const OutlookDays& known) {
    const std::int32_t now_centi = cycle.price_level.centi_eur_per_mwh();
    const std::int32_t planned_centi = planned_level_centi(now_centi);
    if (planned_centi != level_centi || !(known == days)) {
      plan.make(*student_outlook(), known, planned_centi);
      level_centi = planned_centi;
      days = known;
    }
    return plan.break_even_centi(*student_outlook(), cycle.utc_s, cycle.measurement.soc_e4,
                                 now_centi);
  }
};

void add_known(const std::vector<AuctionRow>& rows, std::int64_t from, std::int64_t until,
               OutlookDays& days) {
  for (const AuctionRow& row : rows) {
    if (row.utc_s < from || row.utc_s >= until) continue;
    days.day_ahead_centi[days.index_of(row.utc_s)] =
        static_cast<std::int32_t>(std::lround(100 * row.eur_per_mwh));
  }
}

}  // namespace

/// Recomputes the plan of each decision from the auction's true rows, as many as the log reports,
/// without gaps; none of tomorrow before 13:00 local time.
void judge_outlook(JudgeContext& judging) {
  if (student_outlook() == nullptr) return;
  const std::vector<AuctionRow> rows = day_ahead_rows(judging.scenario);
  const auto made = std::make_unique<RecomputedPlan>();
  std::int64_t planned_day_utc_s = 0;  ///< midnight of the last known day
  for (const CycleRecord& cycle : judging.evidence.log) {
    const OutlookReport& seen = cycle.outlook;
    const bool is_planned = seen.source == OutlookSource::kPlanned;
    if (!is_planned && seen.source != OutlookSource::kUsual) continue;
    OutlookDays days = outlook_days_around(cycle.utc_s);
    if (is_planned) planned_day_utc_s = days.today_utc_s;
    const std::int64_t first =
        is_planned ? cycle.utc_s - cycle.utc_s % kSecondsPerQuarterHour : days.tomorrow_utc_s;
    const std::int64_t until = first + kSecondsPerQuarterHour * seen.known_quarter_hours;
    if (until > days.tomorrow_utc_s && local_minute_of(cycle.utc_s).minute_of_day < 13 * 60)
      judging.find(cycle.utc_s * kSecondNs, "no price of tomorrow before 13:00", "some");
    if (planned_day_utc_s == days.yesterday_utc_s)
      add_known(rows, days.yesterday_utc_s, days.today_utc_s, days);
    add_known(rows, is_planned ? days.today_utc_s : first, until, days);
    const std::int32_t centi = made->break_even_centi(cycle, days);
    if (centi == seen.break_even_centi) continue;
    judging.find(cycle.utc_s * kSecondNs,
                 fmt::format("break-even at {:.2f} EUR/MWh", centi / 100.0),
                 fmt::format("{:.2f}", seen.break_even_centi / 100.0));
  }
}

namespace {

/// Holds and limits in force at a tick; they take precedence over the thresholds.
struct OperatorState {
  bool is_held = false;
  bool is_limited = false;  ///< or was: after an unreadable limit the previous one may apply
};

OperatorState operator_state_at(const JudgeContext& judging, std::int64_t tick_ns) {
  using enum ScenarioEvent::EventKind;
  OperatorState operator_state;
  for (const ScenarioEvent& event : judging.scenario.events) {
    const std::int64_t at_ns = judging.scenario.utc_ns_at(event.at_min);
    if (at_ns > tick_ns + judging.slack_ns()) break;
    const bool is_on = tick_ns < at_ns + event.for_s * kSecondNs + judging.slack_ns();
    if (event.kind == kHold) operator_state.is_held = is_on;
    if (event.kind == kHoldRelease) operator_state.is_held = false;
    if (event.kind == kLimit || event.kind == kLimitTorn) operator_state.is_limited = is_on;
    if (event.kind == kLimitClear) operator_state.is_limited = false;
  }
  const bool needs_limit = judging.config.site.settings.idle_after_timeout;
  operator_state.is_limited =
      operator_state.is_limited || (needs_limit && judging.scenario.has_limits());
  return operator_state;
}

/// Whether the energy of the local day, from the battery trace, reaches the budget of full cycles
/// within the resolution of the display.
bool may_be_spent(const JudgeContext& judging, std::int64_t tick_ns) {
  const std::int32_t budget_e4 = judging.config.control.cycles_per_day_max_e4;
  if (budget_e4 == 0) return false;
  const std::int64_t tick_utc_s = tick_ns / kSecondNs;
  const std::int32_t day = local_day_of(local_minute_of(tick_utc_s));
  double moved_frac = 0;
  double before_frac = judging.scenario.battery.soc_frac;
  for (const MinuteRecord& minute : judging.evidence.minutes) {
    if (minute.minute_utc_s >= tick_utc_s) break;
    if (local_day_of(local_minute_of(minute.minute_utc_s)) == day) {
      moved_frac += std::abs(minute.soc_frac - before_frac);
    }
    before_frac = minute.soc_frac;
  }
  return 1e4 * (moved_frac / 2 + judging.soc_margin_frac()) >= budget_e4;
}

/// Whether the reversals of the last hour have reached their limit.
bool may_be_barred(const JudgeContext& judging, std::int64_t tick_ns, double wanted_w) {
  const std::int32_t most = judging.config.control.reversals_per_hour_max;
  if (most == 0) return false;
  std::int32_t reversals = 0;
  double last_w = 0;
  for (const DispatchEvent& e : judging.evidence.orders) {
    if (e.utc_ns >= tick_ns) break;
    if (e.kind != DispatchEvent::Kind::kOrder || e.power_w == 0) continue;
    const bool is_in_hour = e.utc_ns >= tick_ns - 3'600 * kSecondNs;
    if (is_in_hour && e.power_w * last_w < 0) ++reversals;
    last_w = e.power_w;
  }
  return reversals >= most && wanted_w * last_w < 0;
}

/// Power that one order may reach with the ramp limit.
double ramped_w(const JudgeContext& judging, std::int64_t tick_ns, double wanted_w) {
  const double ramp_w = judging.config.control.guard.ramp_w_max;
  if (ramp_w == 0) return wanted_w;
  const double from_w = judging.command_at(tick_ns).power_w;
  return std::clamp(wanted_w, from_w - ramp_w, from_w + ramp_w);
}

/// Whether the SoC window or the reserve forbids the direction.
bool is_full_or_empty(const JudgeContext& judging, std::int64_t tick_ns, bool charges) {
  const GuardSettings& guard = judging.config.control.guard;
  const double soc_e4 = 1e4 * judging.soc_at(tick_ns);
  const double margin_e4 = guard.soc_hysteresis_e4 + 1e4 * judging.soc_margin_frac();
  if (charges) return soc_e4 > guard.soc_max_e4 - margin_e4;
  const LocalMinute now = local_minute_of(tick_ns / kSecondNs);
  const std::int32_t reserve_e4 = reserve_soc_e4_at(judging.config.control.reserve, now);
  return soc_e4 < std::max(guard.soc_min_e4, reserve_e4) + margin_e4;
}

/// Whether limits at the connection, or a faulty meter, may reduce an order.
bool has_connection(const JudgeContext& judging) {
  const Scenario& scenario = judging.scenario;
  return judging.house.has_value() &&
         (!scenario.edge_meter.empty() || !scenario.meter.fault.faults.empty());
}

}  // namespace

void judge_thresholds(JudgeContext& judging) {
  const GuardSettings& guard = judging.config.control.guard;
  judging.each_tick([&](std::int64_t tick_ns) {
    const auto row = judging.fresh_row(tick_ns);
    if (!row || judging.may_be_frozen(*row) || judging.is_disturbed_in_cycle(tick_ns)) return;
    const double price = row->eur_per_mwh;
    const bool is_low = price <= guard.thresholds.low_eur_per_mwh;
    const bool is_high = price >= guard.thresholds.high_eur_per_mwh;
    if ((!is_low && !is_high) || is_full_or_empty(judging, tick_ns, is_low)) return;
    const OperatorState operator_state = operator_state_at(judging, tick_ns);
    if (operator_state.is_held || may_be_spent(judging, tick_ns)) return;
    const double extreme_w = is_low ? guard.power_w : -guard.power_w;
    if (may_be_barred(judging, tick_ns, extreme_w)) return;
    const double wanted_w = ramped_w(judging, tick_ns, extreme_w);
    const CommandInForce command = judging.command_at(judging.settled_ns(tick_ns));
    if (std::abs(command.power_w - wanted_w) <= 0.01 * guard.power_w) return;
    const bool is_cut = operator_state.is_limited || has_connection(judging);
    if (is_cut && judging.may_be_cut(wanted_w, command.power_w)) return;
    judging.find(judging.settled_ns(tick_ns),
                 fmt::format("{:.0f} W at {:.2f} EUR/MWh", wanted_w, price), watts(command));
  });
}

}  // namespace bess
