// Safety guard: one case per reason, then the precedence between them.
#include "edge/core/control/safety_guard.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <vector>

#include "tests/support/guard_inputs.h"

namespace bess {
namespace {

GuardDecision decide_once(const GuardInputs& in) { return SafetyGuard(GuardSettings{}).decide(in); }

TEST(SafetyGuard, PassesTheStudentThroughWhenAllIsWell) {
  for (const Action action : {Action::kDischarge, Action::kIdle, Action::kCharge}) {
    expect(decide_once(healthy(action)), power_sign(action) * 4'000, Reason::kStudent);
  }
}

struct StopCase {
  const char* name;
  std::function<void(GuardInputs&)> spoil;
  Reason reason;
  std::int32_t power_w = 0;
};

/// In order of precedence: a case further up must win over every case below it.
std::vector<StopCase> cases() {
  using enum Reason;
  return {
      {"clock", [](GuardInputs& in) { in.clock_ok = false; }, kClock},
      {"link", [](GuardInputs& in) { in.link_ok = false; }, kLink},
      {"alarm", [](GuardInputs& in) { in.measurement.alarm = true; }, kAlarm},
      {"hot", [](GuardInputs& in) { in.measurement.temperature_max_deci_c = 501; }, kTemperature},
      {"cold", [](GuardInputs& in) { in.measurement.temperature_min_deci_c = -1; }, kTemperature},
      {"off grid", [](GuardInputs& in) { in.measurement.off_grid = true; }, kOffGrid},
      {"wrong direction", [](GuardInputs& in) { in.supervision = kWrongDirection; },
       kWrongDirection},
      {"jumping SoC", [](GuardInputs& in) { in.supervision = kSocJump; }, kSocJump},
      {"no price", [](GuardInputs& in) { in.has_price = false; }, kNoPrice},
      {"old price", [](GuardInputs& in) { in.price_minute_utc_s = kNow - 360; }, kPriceAge},
      {"soc full", [](GuardInputs& in) { in.measurement.soc_e4 = 10'000; }, kSocFull},
      {"cycle budget", [](GuardInputs& in) { in.cycle_budget_spent = true; }, kCycleBudget},
      {"reversal cap", [](GuardInputs& in) { in.barred_direction = 1; }, kReversalCap},
      {"power limit", [](GuardInputs& in) { in.measurement.charge_w_max = 1'500; }, kPowerLimit,
       1'500},
      {"outside limit", [](GuardInputs& in) { in.site.limit_charge(2'000, kOutsideLimit); },
       kOutsideLimit, 2'000},
      {"import limit", [](GuardInputs& in) { in.site.limit_charge(2'500, kImportLimit); },
       kImportLimit, 2'500},
      {"quarter-hour peak", [](GuardInputs& in) { in.site.limit_charge(3'000, kQuarterHourPeak); },
       kQuarterHourPeak, 3'000},
  };
}

/// At a restart the order in force may come from another controller, or be invalid.
TEST(SafetyGuard, TheRampNeverAllowsMoreThanTheConfiguredPower) {
  SafetyGuard guard({.ramp_w_max = 1'000});
  GuardInputs in = healthy(Action::kCharge);
  for (const std::int32_t previous_w : {10'000, INT32_MAX, INT32_MIN, -10'000}) {
    in.previous_power_w = previous_w;
    EXPECT_LE(std::abs(guard.decide(in).power_w), 4'000) << previous_w;
  }
}

TEST(SafetyGuard, EachReason) {
  for (const StopCase& c : cases()) {
    GuardInputs in = healthy(Action::kCharge);
    c.spoil(in);
    SCOPED_TRACE(c.name);
    expect(decide_once(in), c.power_w, c.reason);
  }
}

TEST(SafetyGuard, PrecedenceOfEveryPair) {
  const std::vector<StopCase> all = cases();
  for (std::size_t high = 0; high < all.size(); ++high) {
    for (std::size_t low = high + 1; low < all.size(); ++low) {
      GuardInputs in = healthy(Action::kCharge);
      all[low].spoil(in);
      all[high].spoil(in);
      EXPECT_EQ(decide_once(in).reason, all[high].reason) << all[high].name << " " << all[low].name;
    }
  }
}

TEST(SafetyGuard, ThresholdsOverruleTheStudentButNotTheSocLimits) {
  GuardInputs cheap = healthy(Action::kDischarge);
  cheap.price_centi_eur_per_mwh = -50'000;
  expect(decide_once(cheap), 4'000, Reason::kPriceLow);
  cheap.measurement.soc_e4 = 10'000;
  expect(decide_once(cheap), 0, Reason::kSocFull);

  GuardInputs dear = healthy(Action::kIdle);
  dear.price_centi_eur_per_mwh = 150'000;
  expect(decide_once(dear), -4'000, Reason::kPriceHigh);
  dear.measurement.soc_e4 = 1'000;
  expect(decide_once(dear), 0, Reason::kSocEmpty);
}

TEST(SafetyGuard, ThresholdsAreExactToTheCent) {
  GuardInputs in = healthy(Action::kIdle);
  in.price_centi_eur_per_mwh = -49'999;
  EXPECT_EQ(decide_once(in).reason, Reason::kStudent);
  in.price_centi_eur_per_mwh = 149'999;
  EXPECT_EQ(decide_once(in).reason, Reason::kStudent);

  SafetyGuard widest({.thresholds = {.low_eur_per_mwh = -15'000, .high_eur_per_mwh = 15'000}});
  in.price_centi_eur_per_mwh = -1'500'000;
  EXPECT_EQ(widest.decide(in).reason, Reason::kPriceLow);
  in.price_centi_eur_per_mwh = 1'499'999;
  EXPECT_EQ(widest.decide(in).reason, Reason::kStudent);
}

TEST(SafetyGuard, AgreementIsNotAnIntervention) {
  GuardInputs in = healthy(Action::kCharge);
  in.price_centi_eur_per_mwh = -60'000;
  expect(decide_once(in), 4'000, Reason::kStudent);
}

TEST(SafetyGuard, SocHysteresisKeepsAReachedBoundClosed) {
  SafetyGuard guard{GuardSettings{}};
  GuardInputs in = healthy(Action::kCharge);
  const auto power_at = [&](std::int32_t soc_e4) {
    in.measurement.soc_e4 = soc_e4;
    return guard.decide(in).power_w;
  };
  EXPECT_EQ(power_at(9'990), 4'000);
  EXPECT_EQ(power_at(10'000), 0);
  EXPECT_EQ(power_at(9'950), 0);      // not yet back inside by the hysteresis
  EXPECT_EQ(power_at(9'949), 4'000);  // open again
  in.student_action = Action::kDischarge;
  EXPECT_EQ(power_at(1'000), 0);
  EXPECT_EQ(power_at(1'050), 0);
  EXPECT_EQ(power_at(1'051), -4'000);
}

/// However extreme the price: a wrong source could send it.
TEST(SafetyGuard, AReversalTooManyIsNotFollowedBeyondTheThresholdsEither) {
  GuardInputs in = healthy(Action::kIdle);
  in.price_centi_eur_per_mwh = 1'000'000;
  in.barred_direction = -1;
  expect(decide_once(in), 0, Reason::kReversalCap);
  in.price_centi_eur_per_mwh = -1'000'000;
  EXPECT_EQ(decide_once(in).power_w, 4'000);
  in.barred_direction = 1;
  in.student_action = Action::kIdle;
  in.price_centi_eur_per_mwh = 5'000;
  EXPECT_EQ(decide_once(in).reason, Reason::kStudent) << "0 W needs no reversal";
}

TEST(SafetyGuard, PriceAgeAndQuarterHour) {
  GuardInputs in = healthy();
  in.price_minute_utc_s = kNow - 60 - 240;  // exactly four minutes after its end: still good
  EXPECT_EQ(decide_once(in).reason, Reason::kStudent);
  in.price_minute_utc_s -= 60;
  EXPECT_EQ(decide_once(in).reason, Reason::kPriceAge);
  in.price_minute_utc_s = kNow + 120;  // from the future
  EXPECT_EQ(decide_once(in).reason, Reason::kPriceAge);

  GuardSettings patient;
  patient.price_age_s_max = 1'800;
  in.price_minute_utc_s = kNow - 120 - 900;  // first minute of the preceding quarter-hour
  EXPECT_EQ(SafetyGuard(patient).decide(in).reason, Reason::kStudent);
  in.price_minute_utc_s -= 60;
  EXPECT_EQ(SafetyGuard(patient).decide(in).reason, Reason::kPriceQuarterHour);
}

TEST(SafetyGuard, TheEstimateOfAnOldPriceCountsForItsTimeOnly) {
  GuardSettings settings;
  settings.stand_in_s_max = 3'600;
  const SafetyGuard guard(settings);
  GuardInputs in = healthy(Action::kDischarge);
  const auto aged = [&](std::int64_t age_s) {
    in.price_minute_utc_s = kNow - 60 - age_s;
    return guard.may_stand_in(in);
  };
  EXPECT_FALSE(aged(240)) << "it is traded on";
  EXPECT_TRUE(aged(241));
  EXPECT_TRUE(aged(3'840));
  EXPECT_FALSE(aged(3'841));
  EXPECT_FALSE(aged(-61)) << "a row of the future";
  EXPECT_FALSE(SafetyGuard(GuardSettings{}).may_stand_in(in)) << "off by default";

  EXPECT_FALSE(aged(3'841));
  in.price_stands_in = true;  // from any source
  EXPECT_EQ(SafetyGuard(settings).decide(in).reason, Reason::kPriceAge);
  EXPECT_TRUE(aged(3'840));
  expect(SafetyGuard(settings).decide(in), -settings.power_w, Reason::kStandIn);
  in.price_is_frozen = true;
  EXPECT_EQ(SafetyGuard(settings).decide(in).reason, Reason::kFrozenPrice);
  in.price_is_frozen = false;
  in.has_price = false;
  EXPECT_EQ(SafetyGuard(settings).decide(in).reason, Reason::kNoPrice);
}

TEST(SafetyGuard, APriceOfTwoQuarterHoursAgoMayBeEstimatedAtAnyAge) {
  GuardSettings settings;
  settings.price_age_s_max = 1'800;
  settings.stand_in_s_max = 600;
  GuardInputs in = healthy(Action::kCharge);
  in.price_minute_utc_s = kNow - 120 - 960;
  EXPECT_EQ(SafetyGuard(settings).decide(in).reason, Reason::kPriceQuarterHour);
  in.price_stands_in = SafetyGuard(settings).may_stand_in(in);
  EXPECT_EQ(SafetyGuard(settings).decide(in).reason, Reason::kStandIn);
}

TEST(SafetyGuard, AFrozenPriceIsNoneWhateverItSays) {
  for (const std::int32_t centi : {0, 9'000, 9'999'900, -9'999'900}) {
    GuardInputs in = healthy(Action::kCharge);
    in.price_centi_eur_per_mwh = centi;
    in.price_is_frozen = true;
    SCOPED_TRACE(centi);
    expect(decide_once(in), 0, Reason::kFrozenPrice);
    in.held = true;
    in.held_power_w = 2'000;
    EXPECT_EQ(decide_once(in).reason, Reason::kHeld) << "a hold needs no price";
  }
}

TEST(SafetyGuard, ALostMeterLeavesNeitherDirection) {
  for (const Action action : {Action::kCharge, Action::kDischarge}) {
    GuardInputs in = healthy(action);
    in.site.forbid(Reason::kMeterLost);
    expect(decide_once(in), 0, Reason::kMeterLost);
  }
}

TEST(SafetyGuard, ExportIsCutAndNeverTurnedIntoCharging) {
  GuardInputs in = healthy(Action::kDischarge);
  in.site.limit_discharge(800, Reason::kExportLimit);
  expect(decide_once(in), -800, Reason::kExportLimit);
  in.site.limit_discharge(-5'000, Reason::kExportLimit);
  EXPECT_EQ(decide_once(in).power_w, 0);
}

TEST(SafetyGuard, ReliefIsBoundedByTheBatterysOwnLimits) {
  GuardInputs in = healthy(Action::kCharge);
  in.site.relief_w = 1'200;
  expect(decide_once(in), -1'200, Reason::kQuarterHourPeak);
  in.site.relief_w = 9'000;  // a house of 9 kW, a battery of 4
  expect(decide_once(in), -4'000, Reason::kQuarterHourPeak);
  in.measurement.discharge_w_max = 500;
  EXPECT_EQ(decide_once(in).power_w, -500);
  in.measurement.soc_e4 = 1'000;
  expect(decide_once(in), 0, Reason::kSocEmpty);
  in = healthy(Action::kDischarge);  // the student allows more than that anyway
  in.site.relief_w = 1'200;
  expect(decide_once(in), -4'000, Reason::kStudent);
}

/// Between two ticks an order is only ever reduced.
TEST(SafetyGuard, ARecheckCutsAndNeverGivesBack) {
  const SafetyGuard guard{GuardSettings{}};
  GuardInputs in = healthy(Action::kCharge);
  in.previous_power_w = 1'000;
  EXPECT_EQ(guard.rechecked_power_w(in), 1'000);
  in.site.limit_charge(300, Reason::kImportLimit);
  EXPECT_EQ(guard.rechecked_power_w(in), 300);
  in.site.relief_w = 700;
  EXPECT_EQ(guard.rechecked_power_w(in), -700);
}

TEST(SafetyGuard, NegativeLiveLimitsMeanZero) {
  GuardInputs in = healthy(Action::kDischarge);
  in.measurement.discharge_w_max = -5;
  expect(decide_once(in), 0, Reason::kPowerLimit);
}

}  // namespace
}  // namespace bess
