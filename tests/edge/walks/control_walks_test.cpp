// Walks over edge/control: guard, budgets, caps, clocks and levels at their bounds.
#include "edge/control/cycle_budget.h"
#include "edge/control/decision_signature.h"
#include "edge/control/frozen_price.h"
#include "edge/control/full_charge.h"
#include "edge/control/hold.h"
#include "edge/control/level_start.h"
#include "edge/control/lost_order_history.h"
#include "edge/control/mode.h"
#include "edge/control/policy.h"
#include "edge/control/price_history.h"
#include "edge/control/quarter_hour_energy.h"
#include "edge/control/reserve.h"
#include "edge/control/reversal_cap.h"
#include "edge/control/safety_guard.h"
#include "edge/control/tick.h"
#include "shared/local_time.h"
#include "tests/edge/walks/walk.h"

namespace bess {
namespace {

constexpr std::int64_t kNowUtcS = 1'679'788'800;  // 2023-03-26, the night of summer time

GuardSettings drawn_guard_settings(Walk& walk) {
  GuardSettings s;
  s.power_w = walk.number(1, 3) * 2'000;
  s.thresholds = {.low_eur_per_mwh = walk.number(-500, 0), .high_eur_per_mwh = walk.number(1, 500)};
  s.soc_min_e4 = walk.number(0, 3) * 500;
  s.soc_max_e4 = 10'000 - walk.number(0, 3) * 500;
  s.soc_hysteresis_e4 = walk.number(0, 2) * 50;
  s.ramp_w_max = walk.once_in(2) ? 0 : walk.number(1, 4) * 500;
  s.price_age_s_max = static_cast<std::int32_t>(walk.one_of({60, 240, 1'800}));
  s.temperature_min_deci_c = walk.number(-10, 5) * 10;
  s.temperature_max_deci_c = walk.number(40, 60) * 10;
  s.full_charge_power_w = walk.number(0, 2) * 1'000;
  return s;
}

SiteRange drawn_range(Walk& walk) {
  SiteRange range;
  if (walk.once_in(3)) range.limit_charge(walk.edge({-1, 0, 1'000, 2'000}), Reason::kImportLimit);
  if (walk.once_in(3)) {
    range.limit_discharge(walk.edge({-1, 0, 1'000, 2'000}), Reason::kExportLimit);
  }
  if (walk.once_in(4)) {
    range.limit_charge(walk.edge({0, 1'000, 2'000}), Reason::kOutsideLimit);
    range.limit_discharge(walk.edge({0, 1'000, 2'000}), Reason::kOutsideLimit);
  }
  if (walk.once_in(40)) range.forbid(Reason::kMeterLost);
  if (walk.once_in(6)) range.relief_w = walk.edge({0, 500, 4'000});
  return range;
}

GuardInputs drawn_inputs(Walk& walk, const GuardSettings& s) {
  GuardInputs in;
  in.now_utc_s = kNowUtcS + walk.from(0, 30) * 120;
  in.clock_ok = !walk.once_in(40);
  in.link_ok = !walk.once_in(40);
  in.reserve_soc_e4 = walk.once_in(2) ? 0 : s.soc_min_e4 + 1'000;
  BatteryMeasurement& m = in.measurement;
  m.soc_e4 = walk.edge({s.soc_min_e4, s.soc_min_e4 + s.soc_hysteresis_e4, s.soc_max_e4,
                        s.soc_max_e4 - s.soc_hysteresis_e4, 5'000, in.reserve_soc_e4,
                        in.reserve_soc_e4 + s.soc_hysteresis_e4});
  m.alarm = walk.once_in(60);
  m.off_grid = walk.once_in(60);
  m.temperature_min_deci_c = walk.once_in(6) ? walk.edge({s.temperature_min_deci_c}) : 200;
  m.temperature_max_deci_c = walk.once_in(6) ? walk.edge({s.temperature_max_deci_c}) : 200;
  if (walk.once_in(4)) m.charge_w_max = walk.edge({0, 1'000, s.power_w});
  if (walk.once_in(4)) m.discharge_w_max = walk.edge({0, 1'000, s.power_w});
  if (walk.once_in(30)) in.supervision = static_cast<Reason>(walk.from(0, kReasonCount - 1));
  in.cycle_budget_spent = walk.once_in(20);
  in.barred_direction = walk.once_in(6) ? walk.number(-1, 1) : 0;
  in.previous_power_w = walk.edge({0, s.power_w, -s.power_w, 2 * s.power_w, s.ramp_w_max});
  in.has_price = !walk.once_in(40);
  const std::int64_t age_s = walk.once_in(2) ? 60 : walk.edge({-60, 0, s.price_age_s_max, 900}, 2);
  in.price_minute_utc_s = in.now_utc_s - 60 - age_s;
  in.price_centi_eur_per_mwh =
      walk.edge({s.thresholds.low_eur_per_mwh * 100, s.thresholds.high_eur_per_mwh * 100, 0});
  in.price_is_frozen = walk.once_in(40);
  in.student_action = static_cast<Action>(walk.from(0, 2));
  in.held = walk.once_in(8);
  in.held_power_w = walk.edge({0, s.power_w, -s.power_w, 700});
  if (walk.once_in(5)) in.full_charge = static_cast<FullChargeWish>(walk.from(0, 2));
  if (walk.once_in(4)) {
    in.rules = {.actions = static_cast<ActionSet>(walk.from(1, kAllActions)),
                .power_permille_max = walk.edge({0, 500, 999}, 1)};
    in.rules.power_permille_max = std::max(in.rules.power_permille_max, 0);
  }
  in.site = drawn_range(walk);
  return in;
}

TEST(ControlWalk, Guard) {
  Walk walk("guard");
  for (int block = 0; block < 40; ++block) {
    const GuardSettings settings = drawn_guard_settings(walk);
    SafetyGuard guard(settings);
    for (int i = 0; i < 1'500; ++i) {
      const GuardInputs in = drawn_inputs(walk, settings);
      const GuardDecision decision = guard.decide(in);
      walk.see(decision.power_w, decision.reason);
      const GuardDecision again = guard.recheck(in);
      walk.see(again.power_w, again.reason);
    }
    walk.end_line(block);
  }
  walk.hold();
}

TEST(ControlWalk, RecordedDays) {
  Walk walk("recorded_days");
  const DecisionSignature days = replay_recorded_days();
  walk.see(days.signature, days.decisions, days.charging, days.discharging);
  walk.end_line("days");
  for (int i = 0; i < 4'000; ++i) {
    const PriceLevel level = PriceLevel::starting_at(walk.number(-50'000, 150'000));
    const GuardInputs in = undisturbed_inputs(
        kNowUtcS + walk.from(0, 500) * 86'400 + walk.from(0, 86'399), walk.number(0, 10'000),
        level.centi_eur_per_mwh(), kNowUtcS, walk.number(-60'000, 160'000));
    const LocalMinute now = local_minute_of(in.now_utc_s);
    const LatticeState state =
        make_lattice_state(now, student_context_class(now, level.centi_eur_per_mwh()),
                           in.measurement.soc_e4, in.price_centi_eur_per_mwh);
    walk.see(in.student_action, in.rules.actions, in.rules.power_permille_max,
             student_context_class(now, level.centi_eur_per_mwh()), guard_rule_count());
    for (int rule = 0; rule < guard_rule_count(); ++rule) {
      walk.see(guard_rule_holds(rule, now, state, in.price_centi_eur_per_mwh));
    }
  }
  walk.end_line("student");
  walk.hold();
}

TEST(ControlWalk, CycleBudget) {
  Walk walk("cycle_budget");
  for (int block = 0; block < 20; ++block) {
    const std::int32_t per_day_e4 = block == 0 ? 0 : walk.number(1, 20) * 500;
    CycleBudget budget(per_day_e4);
    if (walk.once_in(2)) budget.restore({.local_day = 20'230'326, .soc_moved_e4 = 3'000});
    std::int64_t utc_s = kNowUtcS - 86'400;
    for (int i = 0; i < 2'000; ++i) {
      utc_s += 120;
      const std::int32_t local_day = local_day_of(local_minute_of(utc_s));
      budget.update(local_day, walk.number(0, 40) * 10, !walk.once_in(4));
      if (walk.once_in(9)) budget.forget_soc();
      walk.see(local_day, budget.is_spent(), budget.today().local_day, budget.today().soc_moved_e4);
    }
    // The bound itself, reached by steps of one.
    budget.restore({.local_day = 1, .soc_moved_e4 = 2 * per_day_e4 - 8});
    for (int i = 0; i < 20; ++i) {
      budget.update(1, i % 2, true);
      walk.see(budget.is_spent());
    }
    walk.end_line(block);
  }
  walk.hold();
}

TEST(ControlWalk, ReversalCap) {
  Walk walk("reversal_cap");
  for (int block = 0; block < 20; ++block) {
    ReversalCap cap(block % 5);
    std::int64_t utc_s = kNowUtcS;
    if (walk.once_in(2)) {
      cap.restore({.steps = static_cast<std::uint32_t>(walk.from(0, (1 << 30) - 1)),
                   .direction = static_cast<std::int16_t>(walk.from(-1, 1)),
                   .in_hour = static_cast<std::int16_t>(walk.from(0, 6))},
                  utc_s);
    }
    for (int i = 0; i < 1'500; ++i) {
      utc_s += walk.once_in(20)   ? walk.from(-300, 4'200)
               : walk.once_in(12) ? walk.edge({29 * 120, 30 * 120, 31 * 120})
                                  : 120;
      cap.advance(utc_s);
      walk.see(cap.barred_direction(), cap.history().steps, cap.history().direction,
               cap.history().in_hour);
      const std::int32_t power_w = walk.edge({-4'000, -1, 0, 1, 4'000}, 0);
      cap.note(power_w);
      walk.see(cap.barred_direction(), cap.history().steps, cap.history().in_hour);
    }
    walk.end_line(block);
  }
  walk.hold();
}

TEST(ControlWalk, LostOrderHistory) {
  Walk walk("lost_order_history");
  LostOrderHistory history;
  for (int i = 0; i < 400; ++i) {
    history.note(walk.once_in(3));
    walk.see(history.orders, history.judged, history.lost, history.is_found);
  }
  walk.end_line("noted");
  walk.hold();
}

TEST(ControlWalk, Modes) {
  Walk walk("modes");
  for (int bits = 0; bits < 32; ++bits) {
    for (int mode = 0; mode < kModeCount; ++mode) {
      walk.see(next_mode(static_cast<Mode>(mode), {.stop_requested = (bits & 1) != 0,
                                                   .stop_reason = (bits & 2) != 0,
                                                   .hold_elapsed = (bits & 4) != 0,
                                                   .release_now = (bits & 8) != 0,
                                                   .order_found = (bits & 16) != 0}));
      walk.see_text(mode_name(static_cast<Mode>(mode)));
    }
  }
  for (int i = 0; i < kReasonCount; ++i) {
    const auto reason = static_cast<Reason>(i);
    walk.see(is_stop_reason(reason));
    walk.see_text(reason_name(reason));
  }
  walk.end_line("table");
  walk.hold();
}

TEST(ControlWalk, QuarterHourEnergy) {
  Walk walk("quarter_hour_energy");
  for (int block = 0; block < 20; ++block) {
    QuarterHourEnergy energy(block % 3 == 0 ? 0 : 2'500, walk.number(10, 60));
    std::int64_t utc_s = kNowUtcS;
    if (walk.once_in(2)) energy.restore(utc_s, walk.number(0, 900), walk.number(0, 500));
    for (int i = 0; i < 1'000; ++i) {
      utc_s += walk.once_in(60)   ? walk.from(-900, 1'900)
               : walk.once_in(20) ? walk.edge({10, 30, 60, 900})
                                  : walk.from(0, 12);
      if (walk.once_in(10)) utc_s = (utc_s / 900 + 1) * 900 + walk.from(-1, 1);
      energy.add(utc_s, walk.edge({0, 3'000, -2'000}, 700), walk.edge({0, 4'000, -4'000}, 300));
      const QuarterHourEnergy::Sums now = energy.at(utc_s);
      const QuarterHourEnergy::Sums soon = energy.at(utc_s + walk.from(-5, 20));
      walk.see(now.import_ws, now.battery_ws, now.left_s, soon.import_ws, soon.battery_ws,
               soon.left_s);
    }
    walk.end_line(block);
  }
  walk.hold();
}

TEST(ControlWalk, FullChargeAndReserve) {
  Walk walk("full_charge_and_reserve");
  for (int block = 0; block < 20; ++block) {
    FullCharge full(block % 4 * 3);
    ReservePlan plan;
    for (int i = 0; i < block % 5; ++i) {
      plan.push_back({.from_minute = static_cast<std::int16_t>(walk.from(0, 24) * 60),
                      .to_minute = static_cast<std::int16_t>(walk.from(0, 24) * 60),
                      .soc_e4 = static_cast<std::int16_t>(walk.from(0, 8) * 1'000),
                      .months = static_cast<std::uint16_t>(walk.from(1, 0x0FFF))});
    }
    std::int64_t utc_s = kNowUtcS + walk.from(0, 300) * 86'400;
    full.restore(
        last_full_day_of(walk.once_in(3) ? 0 : utc_s, static_cast<std::int16_t>(walk.from(0, 9))));
    for (int i = 0; i < 800; ++i) {
      utc_s += walk.once_in(50) ? walk.from(-3, 12) * 86'400 : walk.from(1, 60) * 60;
      const LocalMinute now = local_minute_of(utc_s);
      full.update(local_day_number(now), walk.once_in(60) ? walk.edge({9'950}) : 5'000);
      const std::int32_t centi = walk.number(-100, 100) * 100;
      PriceLevel level;
      if (!walk.once_in(5)) level = PriceLevel::starting_at(centi + walk.number(-1, 1));
      walk.see(full.days_since_full(), full.wish(centi, level), reserve_soc_e4_at(plan, now));
      for (const ReservePeriod& period : plan) walk.see(period.holds_at(now));
    }
    full.update(1, 0);
    full.update(32'766 + block, 0);
    walk.see(full.days_since_full());
    walk.end_line(block);
  }
  walk.hold();
}

TEST(ControlWalk, Holds) {
  Walk walk("holds");
  HoldMailbox box;
  for (int i = 0; i < 4'000; ++i) {
    const std::int64_t left_s =
        walk.edge({0, 120, kHoldSecondsMax, kHoldSecondsMax + kHoldSecondsMin, 3'600});
    Hold hold{.power_w = walk.edge({0, 4'000, -4'000}),
              .until_utc_s = static_cast<std::uint32_t>(kNowUtcS + left_s),
              .unreadable = walk.once_in(10)};
    if (hold.unreadable && walk.once_in(2)) hold = {.unreadable = true};
    const HoldReport report = hold_at(hold, kNowUtcS);
    box.publish(hold);
    const Hold latest = box.latest();
    walk.see(report.held, report.unreadable, report.power_w, report.until_utc_s, latest.power_w,
             latest.until_utc_s, latest.unreadable);
  }
  walk.end_line("holds");
  for (int i = 0; i < 400; ++i) walk.see(next_tick_utc_s(kNowUtcS + i));
  walk.end_line("ticks");
  walk.hold();
}

TEST(ControlWalk, PriceHistory) {
  Walk walk("price_history");
  for (int block = 0; block < 30; ++block) {
    const int hours = block == 0 ? PriceHistory::kHoursMax : walk.number(1, 6);
    const std::int64_t now_utc_s = kNowUtcS + walk.from(0, 240);
    PriceHistory history(hours, now_utc_s);
    walk.see(history.first_minute_utc_s(), history.hours_covered());
    for (int i = 0; i < hours * walk.number(0, 60); ++i) {
      std::int64_t minute = walk.from(-3, hours * 60 + 3);
      if (walk.once_in(20)) minute = walk.edge({0, hours * 60});
      history.add(history.first_minute_utc_s() + minute * 60 + (walk.once_in(30) ? -1 : 0),
                  walk.number(-60'000, 160'000));
      if (i % 16 == 0) {
        walk.see(history.rows(), history.hours(), history.hours_covered(),
                 history.level().centi_q16, history.level().row_minute_utc_s);
      }
    }
    walk.see(history.level().centi_q16);
    walk.end_line(block);
  }
  walk.hold();
}

TEST(ControlWalk, StartLevel) {
  Walk walk("start_level");
  for (int i = 0; i < 4'000; ++i) {
    PriceLevel logged{
        .centi_q16 = walk.one_of({0, PriceLevel::kMinCenti, PriceLevel::kMaxCenti}) * 65'536 +
                     walk.from(-1, 1),
        .row_minute_utc_s = walk.one_of({0, -1, 1, kNowUtcS - 60, kNowUtcS, kNowUtcS + 86'400})};
    const std::int64_t now_utc_s = walk.one_of({0, 59, 60, 119, 120, kNowUtcS, kNowUtcS + 1});
    const PriceLevel kept = level_from_log(logged, now_utc_s);
    std::optional<std::int32_t> setting;
    if (walk.once_in(2)) setting = walk.number(-100, 100);
    const bool has_history = walk.once_in(2);
    const LevelStart start = find_start_level(
        walk.once_in(2) ? ContextKind::kLevel : ContextKind::kMonth, logged, now_utc_s, setting,
        [&] { return has_history ? PriceLevel::starting_at(77) : PriceLevel{}; });
    walk.see(kept.centi_q16, kept.row_minute_utc_s, start.level.centi_q16, start.source,
             start.refused_log);
  }
  walk.end_line("level");
  walk.hold();
}

TEST(ControlWalk, FrozenPrices) {
  Walk walk("frozen_prices");
  for (int block = 0; block < 40; ++block) {
    FrozenPrice frozen(
        {.frozen_s = block % 5 == 0 ? 0 : 1'800,
         .stop_s =
             block % 7 == 0 ? 0 : static_cast<std::int32_t>(walk.one_of({1'800, 3'600, 10'800}))});
    std::int64_t minute_utc_s = kNowUtcS;
    if (walk.once_in(2)) {
      frozen.restore({.minute_utc_s = minute_utc_s - 120,
                      .centi_eur_per_mwh = 3,
                      .unchanged_s = walk.number(0, 4'000)});
    }
    int values = walk.number(1, 7);
    std::int32_t centi = 3;
    for (int i = 0; i < 1'200; ++i) {
      minute_utc_s += walk.once_in(40) ? walk.from(-4, 20) * 60 : walk.from(1, 4) * 60;
      if (walk.once_in(150)) values = walk.number(1, 7);
      if (walk.once_in(block % 3 == 0 ? 200 : 4)) centi = walk.number(1, values);
      if (walk.once_in(9)) {
        frozen.recall(minute_utc_s, centi);
      } else {
        frozen.observe(minute_utc_s, centi);
      }
      walk.see(frozen.is_frozen(), frozen.is_no_price(), frozen.price().unchanged_s,
               frozen.price().minute_utc_s, frozen.price().centi_eur_per_mwh);
    }
    walk.end_line(block);
  }
  walk.hold();
}

}  // namespace
}  // namespace bess
