// Control loop behind the meter: the real loop, guard and site on a fake clock, against a house
// with changing loads, a meter that falls silent, and outside limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "shared/host/minute_file.h"
#include "tests/support/fake_plant.h"
#include "tools/simulators/battery_sim/house_load.h"

namespace bess {
namespace {

struct FakeMeter {
  Status read(std::int32_t& grid_power_w) {
    if (is_silent) return Status::kTimeout;
    battery.physics.advance(clock.now_ns);
    grid_power_w = static_cast<std::int32_t>(std::lround(grid_w()));
    return Status::kOk;
  }
  [[nodiscard]] double grid_w() const {
    return house.power_w(clock.now_ns / kNanosecondsPerSecond) + battery.physics.power_w();
  }

  FakeClock& clock;
  FakeBattery& battery;
  HouseLoad house;
  bool is_silent = false;
};

struct FakeLimits {
  Status read(OutsideLimit& out, bool& set) const {
    out = limit;
    set = is_set && status == Status::kOk;
    return status;
  }
  OutsideLimit limit;
  bool is_set = false;
  Status status = Status::kOk;
};

using Site = SiteLimits<FakeMeter, FakeLimits>;
using Loop = ControlLoop<FakeBattery, FakePrices, FakeClock, Site>;

struct House {
  House(const SiteSettings& settings, HouseLoad load, const ReservePeriod& reserve)
      : House(settings, std::move(load), 0.5, reserve) {}
  House(const SiteSettings& settings, HouseLoad load, double soc = 0.5,
        const ReservePeriod& reserve = {})
      : battery(clock, soc),
        prices(clock),
        meter{clock, battery, std::move(load)},
        loop(in_control(reserve), battery, prices, clock, Site(settings, &meter, &limits)) {}
  static ControlSettings in_control(const ReservePeriod& reserve) {
    ControlSettings settings{.control = true, .guard = {}};
    settings.reserve.push_back(reserve);
    return settings;
  }
  CycleRecord cycle() { return run_cycle(loop); }
  void let_it(int sign) {
    prices.price = [sign](std::int64_t) { return sign * kCheapCenti; };
  }
  void use(double house_w) { meter.house = HouseLoad::constant(house_w); }

  FakeClock clock;
  FakeBattery battery;
  FakePrices prices;
  FakeMeter meter;
  FakeLimits limits;
  Loop loop;
};

constexpr int kCharge = 1;
constexpr int kDischarge = -1;

TEST(Site, AHouseThatNeedsMoreIsGivenItBeforeTheNextTick) {
  House house(metered({.import_w_max = 5'000, .margin_w = 0}), HouseLoad::constant(500));
  house.let_it(kCharge);
  EXPECT_EQ(house.cycle().ordered_power_w, 4'000);
  house.use(4'200);
  const std::size_t before = house.battery.orders.size();
  const CycleRecord record = house.cycle();
  ASSERT_GT(house.battery.orders.size(), before + 1);  // cut once before the tick's own order
  EXPECT_EQ(house.battery.orders[before].power_w, 800);
  EXPECT_EQ(record.site.order_cuts, 1);
  house.use(500);
  house.clock.now_ns += 60 * kNanosecondsPerSecond;
  EXPECT_EQ(house.cycle().site.order_cuts, 1);  // only restored by a tick
  EXPECT_EQ(house.battery.orders.back().power_w, 4'000);
}

TEST(Site, AMeterThatMayBeLostIsIgnored) {
  SiteSettings settings = metered({.import_w_max = 1'000});
  settings.idle_without_meter = false;
  House house(settings, HouseLoad::constant(500));
  house.let_it(kCharge);
  house.meter.is_silent = true;
  EXPECT_EQ(house.cycle().ordered_power_w, 4'000);
}

TEST(Site, StopReasonsAreStronger) {
  SiteSettings settings = metered({.import_w_max = 5'000});
  settings.has_outside_limits = true;
  House house(settings, HouseLoad::constant(4'900));
  house.limits.status = Status::kMalformed;
  house.let_it(kCharge);
  house.cycle();
  house.battery.alarm = true;
  EXPECT_EQ(house.cycle().reason, Reason::kAlarm);
}

TEST(Site, ACutKeepsTheReserveAndEndsWithTheOrderThatItCuts) {
  House house(metered({.import_w_max = 9'000, .export_w_max = 500, .margin_w = 0}),
              HouseLoad::constant(3'500), {.soc_e4 = 3'000});
  house.let_it(kDischarge);
  EXPECT_EQ(house.cycle().ordered_power_w, -4'000);
  const PowerOrder order = house.battery.orders.back();
  house.clock.now_ns += 50 * kNanosecondsPerSecond;
  house.use(1'000);
  const std::int64_t before_ns = house.clock.now_ns;
  const CycleRecord record = house.cycle();
  ASSERT_EQ(record.site.order_cuts, 1);
  const PowerOrder& cut = house.battery.orders[1];
  EXPECT_EQ(cut.power_w, -1'500);
  EXPECT_EQ(cut.soc_min_e4, 3'000);
  EXPECT_EQ(cut.feed_until_ns, order.feed_until_ns);
  EXPECT_LE(cut.write_until_ns, order.feed_until_ns);
  EXPECT_GT(cut.write_until_ns, before_ns);
  EXPECT_EQ(house.battery.orders[2].soc_min_e4, 3'000);
}

TEST(Site, ACutThatFailsIsMadeAgain) {
  House house(metered({.import_w_max = 5'000, .margin_w = 0}), HouseLoad::constant(500));
  house.let_it(kCharge);
  house.cycle();
  house.use(4'200);
  house.battery.refuses_orders = true;
  const CycleRecord record = house.cycle();
  EXPECT_EQ(record.site.order_cuts, 1);
  EXPECT_GT(house.battery.orders.size(), 5U);
  EXPECT_EQ(record.mode, Mode::kRunning);  // a failure between two ticks does not release it
}

/// The new order would hide the loss.
TEST(Site, AnOrderThatWasLostIsNotCut) {
  for (const bool is_replaced : {true, false}) {
    House house(metered({.import_w_max = 5'000, .margin_w = 0}), HouseLoad::constant(500));
    house.let_it(kCharge);
    house.cycle();
    house.battery.changed = [&](BatteryMeasurement& m) {
      const bool is_lost = house.battery.orders.size() == 1;  // until another order
      m.order_replaced = is_lost && is_replaced;
      m.order_ended = is_lost && !is_replaced;
    };
    house.use(4'200);
    const CycleRecord record = house.cycle();
    EXPECT_EQ(record.site.order_cuts, 0);
    EXPECT_EQ(record.replaced_orders, is_replaced ? 1 : 0);
    EXPECT_EQ(record.ended_orders, is_replaced ? 0 : 1);
  }
}

TEST(Site, ACutThatChangesItsDirectionCountsAsAReversal) {
  ConnectionSettings connection{.peak_w_max = 2'000, .margin_w = 0};
  House house(metered(connection), HouseLoad::constant(0));
  house.clock.now_ns = (kDayStartS / 900 + 1) * 900 * kNanosecondsPerSecond;
  house.let_it(kCharge);
  EXPECT_GT(house.cycle().ordered_power_w, 0);
  house.clock.now_ns += 60 * kNanosecondsPerSecond;
  house.use(6'000);
  const CycleRecord record = house.cycle();
  EXPECT_LT(record.ordered_power_w, 0);
  EXPECT_EQ(record.reversals.in_hour, 1);
  ASSERT_GE(record.site.order_cuts, 1);
  EXPECT_LT(house.battery.orders[1].power_w, 0);
  EXPECT_GT(record.throughput.soc_moved_e4, 0);
}

TEST(Site, WithoutControlNothingIsCut) {
  House house(metered({.import_w_max = 5'000}), HouseLoad::constant(500));
  Loop reader({.control = false, .guard = {}}, house.battery, house.prices, house.clock,
              Site(metered({.import_w_max = 5'000}), &house.meter, &house.limits));
  CycleRecord record;
  for (int i = 0; i < 5; ++i) {
    record = run_cycle(reader);
    house.use(6'000);
  }
  EXPECT_TRUE(house.battery.orders.empty());
  EXPECT_TRUE(record.site.has_grid_power);
}

TEST(Site, ARestartCountsWhatItsLogDoesNotKnowAsTheCap) {
  const ConnectionSettings connection{.peak_w_max = 3'000, .margin_w = 0};
  House house(metered(connection), HouseLoad::constant(1'000));
  house.let_it(kCharge);
  const std::int64_t quarter_s =
      (kDayStartS / 1'800 + 1) * 1'800;  // where ticks meet quarter-hours
  house.clock.now_ns = (quarter_s + 470) * kNanosecondsPerSecond;
  house.loop.take_over({.utc_s = quarter_s + 360, .site = {.quarter_hour_import_wh = 100}});
  const CycleRecord record = house.cycle();  // the tick at 480
  // 100 Wh until 360 s, the cap until the first reading at about 470 s.
  EXPECT_NEAR(record.site.quarter_hour_import_wh, 100 + 110 * 3'000 / 3'600, 12);
  EXPECT_EQ(record.reason, Reason::kQuarterHourPeak);
  EXPECT_LT(record.ordered_power_w, (3'000 * 900 - 100 * 3'600 - 110 * 3'000) / 420 - 1'000 + 20);
}

TEST(Site, PeakShavingKeepsTheHouseItselfUnderTheCap) {
  ConnectionSettings connection{.peak_w_max = 3'000};
  connection.peak_shave = true;
  House house(metered(connection), HouseLoad::constant(4'500));
  house.prices.price = [](std::int64_t) { return 10'000; };
  house.clock.now_ns =
      (kDayStartS / 900 + 1) * 900 * kNanosecondsPerSecond - 5 * kNanosecondsPerSecond;
  std::int32_t import_wh_max = 0;
  for (int i = 0; i < 8; ++i) {
    const CycleRecord record = house.cycle();
    if (i > 0) import_wh_max = std::max(import_wh_max, record.site.quarter_hour_import_wh);
  }
  EXPECT_LE(import_wh_max, 750);
  EXPECT_LT(house.battery.physics.soc_frac(), 0.5);
}

/// Weeks of a household's load, with a meter that is silent now and then: limits are exceeded
/// through the battery only until the next check, or until a silent meter counts as lost.
TEST(Site, ALimitIsPassedForNoLongerThanACheckTakes) {
  constexpr double kImportW = 4'500, kExportW = 500;
  SiteSettings settings = metered({.import_w_max = 4'500, .export_w_max = 500});
  House house(settings, HouseLoad::daily(5));
  std::mt19937_64 random(7);
  // Many values: two alternating values are a frozen source.
  house.prices.price = [&](std::int64_t) {
    const auto cents = static_cast<std::int32_t>(random() % 5'000);
    return random() % 2 == 0 ? -60'000 - cents : 160'000 + cents;
  };
  std::vector<bool> silent_minutes;
  const std::int64_t start_s = house.clock.now_ns / kNanosecondsPerSecond;
  for (int i = 0; i < 21 * kStepsPerDay; ++i) {
    house.meter.is_silent = house.meter.is_silent ? random() % 3 != 0 : random() % 40 == 0;
    silent_minutes.insert(silent_minutes.end(), 2, house.meter.is_silent);
    EXPECT_GE(house.battery.physics.soc_frac(), 0.1 - 1e-9);
    house.cycle();
  }
  int limited = 0;
  for (const MinuteRecord& minute : house.battery.physics.record()) {
    const double house_w = house.meter.house.power_w(minute.minute_utc_s);
    const double grid_w = house_w + minute.energy_wh * 60;
    const double over_w =
        std::max(grid_w - std::max(kImportW, house_w), -grid_w - std::max(kExportW, -house_w));
    limited += minute.energy_wh != 0 && (grid_w > kImportW - 300 || grid_w < -kExportW + 300);
    const auto at = static_cast<std::size_t>((minute.minute_utc_s - start_s) / 60);
    const bool near_silence = silent_minutes[std::min(at, silent_minutes.size() - 1)] ||
                              silent_minutes[std::min(at + 2, silent_minutes.size() - 1)] ||
                              (at >= 2 && silent_minutes[at - 2]);
    const double reaction_s = near_silence ? kMeterAgeMax_s + kSiteCheck_s : kSiteCheck_s;
    ASSERT_LE(over_w * 60, 4'000 * reaction_s + 1) << utc_text(minute.minute_utc_s).c_str();
  }
  EXPECT_GT(limited, 1'000);
}

}  // namespace
}  // namespace bess
