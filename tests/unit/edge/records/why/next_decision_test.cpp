// Next decision, by hand; and keys without effect.
#include "edge/records/why/next_decision.h"

#include <gmock/gmock.h>

#include "edge/records/why/explanation.h"
#include "shared/host/text.h"
#include "shared/local_time.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::int64_t kNoon = 1'679'824'800;  // 2023-03-26T10:00:00Z, 12:00 in Brussels

CycleRecord at_noon(double price_eur) {
  set_market_time_zone();
  CycleRecord r{.utc_s = kNoon, .mode = Mode::kRunning, .reason = Reason::kStudent};
  r.has_measurement = true;
  r.measurement.soc_e4 = 5'000;
  r.price = {.has_row = true,
             .minute_utc_s = kNoon - 60,
             .price_centi_eur_per_mwh = static_cast<std::int32_t>(price_eur * 100)};
  r.price_level = PriceLevel::starting_at(9'000);
  return r;
}

/// The margins are for the next tick: a price on either side of each gives another decision.
TEST(NextDecision, HasTheMarginsOfItsTick) {
  const ControlSettings settings;
  const Margins at = find_next_decision(at_noon(60), kNoon, settings).margins;
  const auto action_at = [&](std::int32_t centi) {
    CycleRecord record = at_noon(0);
    record.price.price_centi_eur_per_mwh = centi;
    return find_next_decision(record, kNoon, settings).action;
  };
  EXPECT_EQ(action_at(at.charge_up_to_centi), Action::kCharge);
  EXPECT_NE(action_at(at.charge_up_to_centi + 1), Action::kCharge);
  EXPECT_EQ(action_at(at.discharge_from_centi), Action::kDischarge);
  EXPECT_NE(action_at(at.discharge_from_centi - 1), Action::kDischarge);
  EXPECT_EQ(next_decision_metrics({}), "");
  const std::string metrics = next_decision_metrics(find_next_decision(at_noon(60), kNoon, {}));
  EXPECT_THAT(metrics, HasSubstr(formatted("\nbess_charge_up_to_eur_per_mwh %.2f\n",
                                           at.charge_up_to_centi / 100.0)));
  EXPECT_THAT(metrics, HasSubstr(formatted("\nbess_discharge_from_eur_per_mwh %.2f\n",
                                           at.discharge_from_centi / 100.0)));
}

TEST(NextDecision, IsThatOfTheNextTickAtTheNewestPrice) {
  const ControlSettings settings;
  const NextDecision cheap = find_next_decision(at_noon(-480), kNoon + 119, settings);
  EXPECT_EQ(cheap.utc_s, kNoon + 120);
  EXPECT_EQ(cheap.action, Action::kCharge);
  EXPECT_EQ(cheap.power_w, 4'000);
  EXPECT_THAT(next_decision_text(cheap), Names("12:02 4000 W"));
  EXPECT_EQ(find_next_decision(at_noon(1'400), kNoon + 120, settings).action, Action::kDischarge);
  EXPECT_EQ(find_next_decision(at_noon(1'400), kNoon + 120, settings).utc_s, kNoon + 240);
}

TEST(NextDecision, NamesTheOverrideOfTheStudent) {
  CycleRecord late = at_noon(60);
  late.reason = Reason::kPriceAge;
  EXPECT_THAT(next_decision_text(find_next_decision(late, kNoon, {})), Names("price_age"));
  late.price.has_row = false;
  const NextDecision blind = find_next_decision(late, kNoon, {});
  EXPECT_THAT(next_decision_text(blind), testing::Not(Names("W")));
  const Json json = Json::parse(next_decision_json(blind).text());
  EXPECT_STREQ(json.value()["reason"].text(), "price_age");
  EXPECT_FALSE(json.value()["power_w"].number().has_value());
}

TEST(NextDecision, LooksADayAheadInThePlan) {
  ControlSettings settings;
  settings.reserve.push_back({.from_minute = 18 * 60, .to_minute = 22 * 60, .soc_e4 = 4'000});
  settings.full_charge_every_days = 14;
  CycleRecord newest = at_noon(60);
  newest.days_since_full = 11;
  const NextDecision next = find_next_decision(newest, kNoon, settings);
  EXPECT_THAT(next_decision_text(next), Names("40.0 % 18:00 22:00 3"));
  // Summer time begins in this night: it looks no further than 22:00 on the day before.
  EXPECT_EQ(next.reserve_changes.size(), 2u);
}

TEST(KeysWithoutEffect, AreNamedWithTheReason) {
  EdgeConfig config;
  config.control.control = true;
  EXPECT_THAT(keys_without_effect(config), IsEmpty());
  config.control.guard.ramp_w_max = 8'000;
  config.control.cycles_per_day_max_e4 = 62'501;
  config.control.reversals_per_hour_max = 30;
  config.control.reserve.push_back({.soc_e4 = 1'000});
  config.site.settings.meter = MeterSource::kBattery;
  EXPECT_THAT(keys_without_effect(config),
              ::testing::ElementsAre(Names("ramp_w_max 8000"), Names("cycles_per_day_max 6.2"),
                                     Names("reversals_per_hour_max"), Names("reserve 10.0 %"),
                                     Names("[meter]")));
  config.site.settings.connection.import_w_max = 5'000;
  config.site.settings.connection.peak_w_max = 5'000;
  EXPECT_THAT(keys_without_effect(config).back(), Names("peak_w_max import_w_max"));
  config.control.control = false;
  EXPECT_THAT(keys_without_effect(config).front(), Names("control = false"));
}

/// One below each bound, and they have an effect again.
TEST(KeysWithoutEffect, AtTheirBoundsTheyHaveOne) {
  EdgeConfig config;
  config.control.control = true;
  config.control.guard.ramp_w_max = 7'999;
  config.control.cycles_per_day_max_e4 = 62'500;
  config.control.reversals_per_hour_max = 29;
  config.control.reserve.push_back({.soc_e4 = 1'001});
  config.site.settings.meter = MeterSource::kBattery;
  config.site.settings.connection.import_w_max = 5'001;
  config.site.settings.connection.peak_w_max = 5'000;
  EXPECT_THAT(keys_without_effect(config), IsEmpty());
}

}  // namespace
}  // namespace bess
