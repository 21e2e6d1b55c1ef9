// Judge: each invariant finds its violation in a hand-made record, and nothing in a good one.
#include <gtest/gtest.h>

#include <algorithm>

#include "shared/scaled_clock.h"
#include "tools/hil_runner/base/work_folder.h"
#include "tools/hil_runner/judge/judge.h"
#include "tools/hil_runner/scenario/edge_settings.h"
#include "tools/hil_runner/scenario/rules.h"

namespace bess {
namespace {

constexpr std::int64_t kStartS = 1'679'788'800;

/// Twenty minutes at 0 W, then released: no finding.
struct HandMade {
  Scenario scenario;
  MinuteSeries prices;
  EdgeConfig config;
  Evidence evidence;

  HandMade() {
    scenario.name = scenario.path = "by hand";
    scenario.start_utc_s = kStartS;
    scenario.minutes = 20;
    scenario.battery.map = BESS_SOURCE_DIR "/edge/device/maps/alphaess.toml";
    scenario.prices.steps = {{0, 100}};
    for (const RuleInfo& info : kRuleInfos) scenario.invariants.emplace_back(info.name);
    for (int minute = 0; minute < 20; minute += 2) order(minute, 0);
    evidence.orders.push_back(
        {.utc_ns = at_ns(20, 1), .kind = DispatchEvent::Kind::kStop, .soc_frac = 0.5});
    for (int minute = 0; minute < 20; ++minute) {
      evidence.minutes.push_back({.minute_utc_s = kStartS + 60 * minute,
                                  .energy_wh = 0,
                                  .soc_frac = 0.5,
                                  .commanded_power_w = 0});
    }
    CycleRecord stopping;
    stopping.utc_s = kStartS + 1'200;
    stopping.mode = Mode::kStopping;
    evidence.log.push_back(stopping);
    evidence.is_alive_at_end = true;
  }
  static std::int64_t at_ns(int minute, int second = 0) {
    return (kStartS + 60 * minute + second) * kNanosecondsPerSecond;
  }
  void order(int minute, double power_w, int second = 1) {
    evidence.orders.push_back({.utc_ns = at_ns(minute, second),
                               .kind = DispatchEvent::Kind::kOrder,
                               .power_w = power_w,
                               .duration_s = 300,
                               .soc_frac = 0.5});
  }
  DispatchEvent& order_of(int minute) {
    return evidence.orders[static_cast<std::size_t>(minute / 2)];
  }
  /// A control cycle that wrote an order of such power.
  CycleRecord& log_cycle(int minute, std::int32_t power_w) {
    CycleRecord cycle;
    cycle.utc_s = kStartS + 60 * minute;
    cycle.mode = Mode::kRunning;
    cycle.written = true;
    cycle.ordered_power_w = power_w;
    cycle.reason = Reason::kPriceAge;
    return *evidence.log.insert(evidence.log.begin(), cycle);
  }

  /// The violated rules, in one text.
  std::string broken() {
    prices = scenario_prices(scenario);
    const WorkFolder folder;
    config =
        load_edge_settings(scenario, folder.file("edge.toml"), edge_settings(scenario, prices, {}));
    std::string rules;
    for (const Finding& f : judge({scenario, prices, config, evidence})) {
      rules += (rules.empty() ? "" : " ") + f.rule;
    }
    return rules;
  }
};

/// A defect of a record, and the rules that it violates.
struct Defect {
  void (*make)(HandMade& run);
  const char* broken;
};
constexpr Defect kDefects[] = {
    {[](HandMade&) {}, ""},
    {[](HandMade& run) {
       for (MinuteRecord& m : run.evidence.minutes) m.soc_frac = 0.09;
       run.scenario.battery.soc_frac = 0.09;
     },
     "soc_window"},
    {[](HandMade& run) { run.order_of(8).power_w = 4'100; }, "power_limit"},
    {[](HandMade& run) {  // too late
       run.order_of(8).utc_ns = HandMade::at_ns(9, 30);
       run.order_of(8).power_w = 2'000;
     },
     "in_time"},
    {[](HandMade& run) { run.order_of(8).kind = DispatchEvent::Kind::kExpiry; }, "fed in_control"},
    {[](HandMade& run) {  // released without a hold
       run.order_of(8).power_w = 2'000;
       run.order_of(10).kind = DispatchEvent::Kind::kStop;
     },
     "held in_control"},
    {[](HandMade& run) { run.evidence.orders.pop_back(); }, "released"},
    {[](HandMade& run) { run.evidence.minutes[3].energy_wh = 60; }, "energy"},
    {[](HandMade& run) { run.evidence.edge_exit_code = 1; }, "end"},
};

TEST(Judge, FindsEachDefectAndNothingInAGoodRecord) {
  for (const Defect& defect : kDefects) {
    HandMade run;
    defect.make(run);
    EXPECT_EQ(run.broken(), defect.broken);
  }
}

TEST(Judge, SeesPowerOnAStalePrice) {
  HandMade run;
  run.scenario.prices.missing = {{.from_min = 4, .to_min = 20}};
  EXPECT_EQ(run.broken(), "");
  run.order_of(14).power_w = 2'000;
  EXPECT_EQ(run.broken(), "fresh_price");
}

TEST(Judge, SeesAThresholdThatIsNotFollowed) {
  HandMade run;
  run.scenario.prices.steps = {{0, 100}, {7, -600}, {9, 100}};
  EXPECT_EQ(run.broken(), "thresholds");
  run.order_of(8).power_w = 4'000;
  EXPECT_EQ(run.broken(), "");
}

/// 0 W at minute 8 and a price, with settings of the guard; only the thresholds are judged.
HandMade at_rest(double eur_per_mwh, const char* guard = "") {
  HandMade run;
  run.scenario.invariants = {"thresholds"};
  run.scenario.prices.steps = {{0, 100}, {7, eur_per_mwh}, {9, 100}};
  run.scenario.edge_guard = guard;
  return run;
}

TEST(Judge, KnowsHoldsAndLimitsAboveTheThresholds) {
  using enum ScenarioEvent::EventKind;
  HandMade held = at_rest(-600);
  held.scenario.events = {{.at_min = 5, .kind = kHold, .for_s = 600}};
  EXPECT_EQ(held.broken(), "");
  held.scenario.events.push_back({.at_min = 6, .kind = kHoldRelease});
  EXPECT_EQ(held.broken(), "thresholds");
  HandMade over = at_rest(-600);
  over.scenario.events = {{.at_min = 1, .kind = kHold, .for_s = 120}};
  EXPECT_EQ(over.broken(), "thresholds");
  HandMade limited = at_rest(-600);
  limited.scenario.events = {{.at_min = 5, .kind = kLimit, .for_s = 600, .charge_w = 1'000}};
  limited.order_of(8).power_w = 1'000;
  EXPECT_EQ(limited.broken(), "");
  limited.order_of(8).power_w = -1'000;
  EXPECT_EQ(limited.broken(), "thresholds");
}

TEST(Judge, KnowsReserveBudgetAndCapsAboveTheThresholds) {
  EXPECT_EQ(at_rest(1'600).broken(), "thresholds");
  HandMade kept = at_rest(1'600);
  kept.scenario.edge_other = "[[reserve]]\nfrom = \"00:00\"\nto = \"24:00\"\nsoc = 0.5\n";
  EXPECT_EQ(kept.broken(), "");
  kept.scenario.prices.steps[1].value = -600;  // it may still charge
  EXPECT_EQ(kept.broken(), "thresholds");
  HandMade spent = at_rest(1'600, "cycles_per_day_max = 0.2");
  EXPECT_EQ(spent.broken(), "thresholds");
  for (std::size_t minute = 1; minute < 7; minute += 2) {
    spent.evidence.minutes[minute].soc_frac = 0.57;  // alternating: 0.21 full cycles
  }
  EXPECT_EQ(spent.broken(), "");
  HandMade barred = at_rest(-600, "reversals_per_hour_max = 1");
  barred.order_of(2).power_w = 4'000;
  EXPECT_EQ(barred.broken(), "thresholds");
  barred.order_of(4).power_w = -4'000;
  EXPECT_EQ(barred.broken(), "");
}

TEST(Judge, ExpectsOfARampWhatItLetsGo) {
  HandMade run = at_rest(-600, "ramp_w_max = 1000");
  EXPECT_EQ(run.broken(), "thresholds");
  run.order_of(8).power_w = 1'000;
  EXPECT_EQ(run.broken(), "");
  run.order_of(8).power_w = 4'000;
  EXPECT_EQ(run.broken(), "thresholds");
}

TEST(Judge, SeesMoreWritesOfFlashThanTheMapAllows) {
  HandMade run;
  run.scenario.battery.map = BESS_SOURCE_DIR "/edge/device/maps/huawei_luna2000.toml";
  run.evidence.log.back().counters.flash_writes_today = 48;
  EXPECT_EQ(run.broken(), "");
  run.evidence.log.back().counters.flash_writes_today = 49;
  EXPECT_EQ(run.broken(), "flash");
}

TEST(Judge, SeesPowerAfterTheLinkIsLost) {
  HandMade run;
  run.scenario.battery_faults.emplace_back() = {
      .faults = {BatteryFault::kSilence}, .every = 1, .from_s = 60, .to_s = 1'200};
  EXPECT_EQ(run.broken(), "");
  run.order_of(10).power_w = 2'000;
  EXPECT_EQ(run.broken(), "safe_state");
}

/// A house of 500 W behind a meter, with these limits of the connection.
HandMade with_house(const char* limits) {
  HandMade run;
  run.scenario.house.steps = {{0, 500}};
  run.scenario.meter = {.source = ScenarioMeter::Source::kMap,
                        .map = BESS_SOURCE_DIR "/edge/device/meters/simulator.toml",
                        .variant = "",
                        .fault = {}};
  run.scenario.edge_meter = limits;
  run.scenario.invariants = {"connection"};
  return run;
}

void flow(HandMade& run, std::size_t minute, double power_w) {
  run.evidence.minutes[minute].energy_wh = power_w / 60;
}

TEST(Judge, SeesABatteryThatLeadsTheConnectionBeyondItsLimits) {
  HandMade run = with_house("import_w_max = 3000\nexport_w_max = 1000");
  flow(run, 4, 2'600);  // a minute's rise is the house's
  flow(run, 6, 2'500);
  flow(run, 7, 2'500);
  flow(run, 9, -1'600);
  EXPECT_EQ(run.broken(), "");
  flow(run, 5, 2'600);
  EXPECT_EQ(run.broken(), "connection");
  flow(run, 5, 0);
  flow(run, 10, -1'600);
  EXPECT_EQ(run.broken(), "connection");
  run.scenario.house.steps = {{0, 500}, {10, 700}};
  EXPECT_EQ(run.broken(), "");
  // The house load alone beyond it is no violation.
  run.scenario.house.steps = {{0, 4'000}};
  run.evidence.minutes[4].energy_wh = run.evidence.minutes[6].energy_wh =
      run.evidence.minutes[7].energy_wh = 0;
  EXPECT_EQ(run.broken(), "");
}

TEST(Judge, SeesABatteryThatMakesAQuarterHoursPeak) {
  HandMade run = with_house("peak_w_max = 1000");
  for (std::size_t minute = 0; minute < 15; ++minute) flow(run, minute, 500);
  EXPECT_EQ(run.broken(), "");
  flow(run, 14, 520);
  EXPECT_EQ(run.broken(), "connection");
  flow(run, 13, 0);
  EXPECT_EQ(run.broken(), "");
  // Energy that it charged and discharged does not count as its own.
  run.scenario.house.steps = {{0, 500}, {10, 3'000}};
  for (std::size_t minute = 10; minute < 15; ++minute) flow(run, minute, -1'000);
  EXPECT_EQ(run.broken(), "");
}

TEST(Judge, AttributesAnOrderThatTheSiteCutToTheEdge) {
  HandMade run = with_house("import_w_max = 3000");
  run.scenario.invariants = {"order", "in_time"};
  run.order_of(8).power_w = 2'000;
  const auto cut = [&](double power_w) {
    DispatchEvent event = run.order_of(8);
    event.utc_ns = HandMade::at_ns(9, 10);
    event.power_w = power_w;
    return event;
  };
  run.evidence.orders.insert(run.evidence.orders.begin() + 5, cut(1'000));
  EXPECT_EQ(run.broken(), "");
  run.evidence.orders[5] = cut(2'500);  // it may not discharge
  EXPECT_EQ(run.broken(), "in_time");
  run.evidence.orders[5] = cut(-1'000);
  EXPECT_EQ(run.broken(), "in_time");
  run.scenario.edge_meter = "peak_w_max = 1000";  // except for a peak
  EXPECT_EQ(run.broken(), "");
}

/// An order that the tick finds in force is not written again; a rise of the house load some
/// seconds later cuts it before the judge evaluates it.
TEST(Judge, AttributesAnOrderInForceThatWasCutImmediatelyToTheEdge) {
  HandMade run = with_house("import_w_max = 3000");
  run.scenario.invariants = {"order"};
  run.log_cycle(10, 2'000);
  run.order_of(8).power_w = 2'000;
  run.order_of(10).utc_ns = HandMade::at_ns(10, 11);  // the cut; nothing at the tick itself
  EXPECT_EQ(run.broken(), "");
  run.order_of(8).power_w = 1'000;  // it was never in force
  EXPECT_EQ(run.broken(), "order");
  run.order_of(8).power_w = 2'000;
  run.order_of(10).power_w = 2'500;  // nothing was cut
  EXPECT_EQ(run.broken(), "order");
  run.order_of(10).power_w = 0;
  run.order_of(8).kind = DispatchEvent::Kind::kExpiry;  // it had expired
  EXPECT_EQ(run.broken(), "order");
}

TEST(Judge, HoldsTheLogAgainstMarketBatteryAndStudent) {
  HandMade run;
  CycleRecord& logged = run.log_cycle(8, 0);
  logged.has_measurement = logged.price.has_row = true;
  logged.measurement.soc_e4 = 5'000;
  logged.price.minute_utc_s = kStartS + 420;
  logged.price.price_centi_eur_per_mwh = 10'000;
  const CycleRecord cycle = logged;
  EXPECT_EQ(run.broken(), "");
  run.evidence.log[0].ordered_power_w = 4'000;
  EXPECT_EQ(run.broken(), "order");
  run.evidence.log[0] = cycle;
  run.evidence.log[0].price.price_centi_eur_per_mwh = 10'010;
  EXPECT_EQ(run.broken(), "inputs");
  run.evidence.log[0] = cycle;
  run.evidence.log[0].measurement.soc_e4 = 5'600;
  EXPECT_EQ(run.broken(), "inputs");
  run.evidence.log[0] = cycle;
  run.evidence.log[0].has_student_action = true;  // without context class
  EXPECT_EQ(run.broken(), "decision");
}

/// 30 s late: a bus with a fault may take that long, a healthy one may not.
TEST(Judge, GivesAnOrderUntilItsDeadlineWhereTheBusIsDisturbed) {
  HandMade run;
  run.log_cycle(8, 2'000);
  run.order_of(8).power_w = 2'000;
  run.order_of(8).utc_ns = HandMade::at_ns(8, 40);
  run.scenario.invariants = {"order"};
  EXPECT_EQ(run.broken(), "order");
  run.scenario.battery_faults.emplace_back() = {.faults = {BatteryFault::kByteGap}, .every = 5};
  EXPECT_EQ(run.broken(), "");
  run.order_of(8).utc_ns = HandMade::at_ns(9, 10);
  EXPECT_EQ(run.broken(), "order");
}

TEST(Judge, HoldsPowerAgainstTheRangeThatIsExpected) {
  HandMade run;
  run.scenario.expectations = {{.span = {.from_min = 4, .to_min = 12},
                                .power_w_min = -10,
                                .power_w_max = 1'000,
                                .reason = "",
                                .no_reason = ""}};
  EXPECT_EQ(run.broken(), "");
  run.order_of(8).power_w = 1'001;
  EXPECT_EQ(run.broken(), "expect 1");
  run.order_of(8).power_w = -11;
  EXPECT_EQ(run.broken(), "expect 1");
}

const ExpectedCommand& expected(std::string_view name) {
  return *std::ranges::find(kExpectedCommands, name, &ExpectedCommand::name);
}

TEST(Judge, HoldsTheRunAgainstWhatTheScenarioExpects) {
  HandMade run;
  Expectation expectation;
  expectation.span = {.from_min = 4, .to_min = 10};
  expectation.command = expected("zero");
  run.scenario.expectations = {expectation};
  EXPECT_EQ(run.broken(), "");
  run.scenario.expectations[0].command = expected("charge");
  EXPECT_EQ(run.broken(), "expect 1");
  run.scenario.expectations[0].command = expected("any");
  run.scenario.expectations[0].reason = "alarm";
  EXPECT_EQ(run.broken(), "expect 1");
}

}  // namespace
}  // namespace bess
