// Battery driver beyond writing a map: no repeated write, the watchdog in time, flash within its
// budget, back to the device's own mode after a partial command, no stale or implausible value
// used.
#include "edge/device/battery/battery_driver.h"

#include <gmock/gmock.h>

#include "edge/device/registers/map_file.h"
#include "tests/support/register_device.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr const char* kMapToml = R"(
map = { name = "test", unit = 1 }
power = { charge_w_max = 10000, discharge_w_max = 10000 }
writes = { eeprom_writes_per_day = 5, reserve = 1 }
point = [
  { name = "soc", address = 0, scale = 100, min = 0, max = 10000 },
  { name = "battery_power", address = 1, type = "s16", min = -10000, max = 10000 },
  { name = "enable", address = 10, min = 0, max = 1 },
  { name = "power", address = 11, type = "s16", min = -10000, max = 10000 },
  { name = "time", address = 12, min = 0, max = 3600 },
  { name = "mode", address = 20, storage = "eeprom", min = 0, max = 9 },
  { name = "status", address = 21, names = { busy = 0, ready = 7 }, min = 0, max = 9 },
]
[watchdog]
kind = "duration"
duration_s = 300
refresh_s = 120
[state]
measure = ["soc", "battery_power"]
active = ["enable = 1"]
order_power = "power"
[command]
order = [["power = power", "time = duration"], "enable = 1"]
release = ["enable = 0"]
)";

/// With an identity check.
const std::vector<std::pair<std::string, std::string>> kIdentity = {
    {"[command]\n",
     "[[identity]]\npoint = \"mode\"\nmin = 0\nmax = 7\nhint = \"is it this "
     "device?\"\n[command]\n"}};

/// The map above with some texts replaced.
class DriverTest : public ::testing::Test {
 protected:
  MapUnderTest& with(const std::vector<std::pair<std::string, std::string>>& changes = {}) {
    std::string text = kMapToml;
    for (const auto& [before, after] : changes) {
      const std::size_t at = text.find(before);
      EXPECT_NE(at, std::string::npos) << before;
      text.replace(at, before.size(), after);
    }
    test_ = std::make_unique<MapUnderTest>(folder_.write("map.toml", text));
    test_->device.set(0, {50, 0});
    return *test_;
  }
  /// And 1 kW in force.
  MapUnderTest& with_order(const std::vector<std::pair<std::string, std::string>>& changes = {}) {
    EXPECT_EQ(with(changes).order(1'000), Status::kOk);
    return *test_;
  }

  TemporaryFolder folder_;
  std::unique_ptr<MapUnderTest> test_;
};

TEST_F(DriverTest, AnOrderInForceCostsNoWriteUntilItsWatchdogIsDue) {
  MapUnderTest& t = with();
  EXPECT_THAT(t.writes_of(1'000), SizeIs(2));
  t.device.pass_s(59);
  EXPECT_THAT(t.writes_of(1'000), IsEmpty());
  EXPECT_EQ(t.driver->counters().unchanged_orders, 1);
  t.device.pass_s(61);  // a control cycle after the first
  EXPECT_THAT(t.writes_of(1'000), SizeIs(2));
  EXPECT_THAT(t.writes_of(1'001), SizeIs(2));
  EXPECT_EQ(t.driver->counters().unchanged_orders, 1);
  EXPECT_EQ(t.driver->counters().register_writes, 6);
}

TEST_F(DriverTest, RefreshFeedsOnlyWhenDueAndOnlyAnOrderInForce) {
  MapUnderTest& t = with({{"duration_s = 300", "duration_s = 60"},
                          {"refresh_s = 120", "refresh_s = 20"},
                          {"release =", "refresh = [\"time = duration\"]\nrelease ="}});
  EXPECT_EQ(t.driver->refresh_interval_s(), 20);
  ASSERT_EQ(t.driver->refresh(), Status::kOk);
  EXPECT_EQ(t.device.reads, 0);
  ASSERT_EQ(t.order(1'000), Status::kOk);
  t.device.take_writes();
  t.device.pass_s(5);
  EXPECT_THAT(t.refresh_writes(), IsEmpty());
  t.device.pass_s(15);
  EXPECT_THAT(t.refresh_writes(), ::testing::ElementsAre(WriteRecord{1, 16, 12, {60}}));
  ASSERT_EQ(t.driver->release(), Status::kOk);
  t.device.take_writes();
  t.device.pass_s(60);
  EXPECT_THAT(t.refresh_writes(), IsEmpty());
}

TEST_F(DriverTest, AFailedRefreshIsTriedAgainByTheNextOrder) {
  MapUnderTest& t = with_order();
  t.device.pass_s(120);
  t.device.exception = -1;
  EXPECT_EQ(t.driver->refresh(), Status::kTimeout);
  t.device.exception = 0;
  t.device.take_writes();
  EXPECT_THAT(t.writes_of(1'000), SizeIs(2));
}

/// One lost reading after a reversal would otherwise look like power against the order.
TEST_F(DriverTest, AnOrderIsNotJudgedByTheRegistersOfThePreviousOne) {
  MapUnderTest& t = with_order();
  ASSERT_TRUE(t.reading().has_order_power);
  ASSERT_EQ(t.order(-1'000), Status::kOk);
  for (const int address : {10, 11, 12}) t.device.missing.push_back({.address = address});
  EXPECT_TRUE(t.reading().dispatch_active);
  EXPECT_FALSE(t.measured.has_order_power);
}

TEST_F(DriverTest, AnOrderOfThePreviousRunIsNotOverlooked) {
  MapUnderTest& t = with();
  t.device.set(10, {1, 1'000});
  t.device.missing = {{.address = 10}};
  EXPECT_NE(t.read(), Status::kOk);
  t.device.missing.clear();
  EXPECT_TRUE(t.reading().dispatch_active);
}

TEST_F(DriverTest, AGridPowerThatWasNotReadIsNone) {
  MapUnderTest& t =
      with({{"point = [\n",
             "point = [\n  { name = \"grid_power\", address = 40, type = \"s16\", min = -10000, "
             "max = 10000 },\n"}});
  ASSERT_TRUE(measure_grid_power(t.map));
  ASSERT_TRUE(t.reading().has_grid_power);
  t.device.missing = {{.address = 40}};
  EXPECT_FALSE(t.reading().has_grid_power);
}

TEST_F(DriverTest, AnExpiredOrOverwrittenOrderIsWrittenAgain) {
  MapUnderTest& t = with_order();
  t.device.set(10, {0});  // the device shows that its timer has expired
  EXPECT_FALSE(t.reading().dispatch_active);
  t.device.take_writes();
  EXPECT_THAT(t.writes_of(1'000), SizeIs(2));
  t.device.set(11, {777});  // another controller
  EXPECT_EQ(t.reading().order_power_w, 777);
  EXPECT_THAT(t.writes_of(1'000), SizeIs(2));
}

TEST_F(DriverTest, AnotherMastersValueIsSeenAndNotFedAgainst) {
  MapUnderTest& t = with_order();
  EXPECT_FALSE(t.reading().order_replaced);
  t.device.take_writes();
  t.device.set(11, {777});
  t.device.pass_s(100);  // the watchdog is due
  EXPECT_EQ(t.driver->refresh(), Status::kNotApplied);
  EXPECT_THAT(t.device.take_writes(), IsEmpty());
  EXPECT_TRUE(t.reading().order_replaced);
  ASSERT_EQ(t.order(1'000), Status::kOk);  // where control insists
  EXPECT_FALSE(t.reading().order_replaced);
}

/// Device registers: 10 enable, 11 power, 12 time.
TEST_F(DriverTest, AnOrderThatEndsEarlyIsReportedByItsTraces) {
  struct Case {
    const char* name;
    std::vector<std::pair<int, int>> registers;
    bool replaced, ended;
  };
  const Case cases[] = {
      {"stopped, or ended by the device", {{10, 0}}, false, true},
      {"released by another controller", {{10, 0}, {11, 0}}, true, false},
      {"another power", {{11, 777}}, true, false},
      {"another time", {{12, 30}}, true, false},
      {"another power that has run out", {{10, 0}, {11, 777}}, true, false},
      {"as ordered", {}, false, false},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    for (const bool fed : {false, true}) {  // found by the reading, or by the refresh before it
      MapUnderTest& t = with();
      ASSERT_EQ(t.order(1'000), Status::kOk);
      t.device.pass_s(110);
      for (const auto& [address, value] : c.registers) t.device.set(address, {value});
      if (fed) {
        EXPECT_EQ(t.driver->refresh(), c.replaced || c.ended ? Status::kNotApplied : Status::kOk);
      }
      for (int i = 0; i < 2; ++i) {  // reported until it is ordered again
        EXPECT_EQ(t.reading().order_replaced, c.replaced);
        EXPECT_EQ(t.measured.order_ended, c.ended);
      }
      ASSERT_EQ(t.order(1'000), Status::kOk);
      EXPECT_FALSE(t.reading().order_replaced || t.measured.order_ended);
      EXPECT_TRUE(t.measured.dispatch_active);
    }
  }
}

TEST_F(DriverTest, AnotherModeThanTheReleasesComesFromAnotherController) {
  MapUnderTest& t = with({{"order = [", "enable = [\"mode = 3\"]\norder = ["},
                          {"release = [", "release = [\"mode = 1\", "},
                          {"active = [", "active = [\"mode = 3\", "}});
  for (const auto& [mode, replaced] : {std::pair{2, true}, {1, false}}) {
    t.device.set(20, {1});
    ASSERT_EQ(t.order(1'000), Status::kOk);
    t.device.pass_s(110);
    t.device.set(20, {mode});
    EXPECT_EQ(t.reading().order_replaced, replaced) << mode;
    EXPECT_EQ(t.measured.order_ended, !replaced) << mode;
    t.device.day += 1;  // another day's writes to the flash
  }
}

/// Where the end of an order is invisible, its enabling register still shows it.
TEST_F(DriverTest, AModeThatEnabledTheOrderIsWatched) {
  MapUnderTest& t = with_order({{"order = [", "enable = [\"mode = 3\"]\norder = ["},
                                {"refresh_s = 120", "refresh_s = 120\nexpiry_visible = false"}});
  t.device.pass_s(110);
  t.device.set(20, {1});
  EXPECT_TRUE(t.reading().order_replaced);
}

TEST_F(DriverTest, AnOrderWhoseTimeIsOverWasNotLost) {
  for (const double passed_s : {271.0, 3'600.0}) {
    for (const bool fed : {false, true}) {
      MapUnderTest& t = with();
      ASSERT_EQ(t.order(1'000), Status::kOk);
      t.device.pass_s(passed_s);  // the process was stopped, the link down
      t.device.set(10, {0});
      if (fed) {
        EXPECT_EQ(t.driver->refresh(), Status::kNotApplied);
      }
      EXPECT_FALSE(t.reading().order_replaced || t.measured.order_ended) << passed_s;
    }
  }
}

/// The link fails during the closer look at the end of an order.
TEST_F(DriverTest, AnEndIsNoOtherControllerEvenWhereTheReadingFails) {
  MapUnderTest& t = with_order();
  t.device.pass_s(110);
  t.device.set(10, {0});
  t.device.unreadable_address = 0;
  EXPECT_EQ(t.driver->refresh(), Status::kNotApplied);
  t.device.unreadable_address = -1;
  EXPECT_TRUE(t.reading().order_ended);
  EXPECT_FALSE(t.measured.order_replaced);
}

TEST_F(DriverTest, AnOrderThatRunsOutWhileItIsReadWasNotLost) {
  MapUnderTest& t = with_order();
  t.device.pass_s(299);
  const int reads = t.device.reads;
  t.device.before_request = [&] {
    if (t.device.reads == reads + 3) t.device.set(10, {0});  // after the two of the measurement
  };
  EXPECT_TRUE(t.reading().dispatch_active);
  EXPECT_FALSE(t.measured.order_replaced || t.measured.order_ended);
}

TEST_F(DriverTest, AnOrderThatShowsLateIsNotLost) {
  MapUnderTest& t = with_order({{"active = [\"enable = 1\"]", "active = [\"status = ready\"]"}});
  t.device.pass_s(10);
  EXPECT_FALSE(t.reading().dispatch_active);
  EXPECT_FALSE(t.measured.order_ended);
  t.device.set(21, {7});
  EXPECT_TRUE(t.reading().dispatch_active);
  t.device.set(21, {0});
  t.device.pass_s(10);
  EXPECT_TRUE(t.reading().order_ended);
}

TEST_F(DriverTest, WhatWeGiveBackOrCannotFeedWasNotLost) {
  MapUnderTest& t = with_order();
  ASSERT_EQ(t.driver->release(), Status::kOk);
  EXPECT_FALSE(t.reading().order_replaced || t.measured.order_ended);
  ASSERT_EQ(t.order(1'000), Status::kOk);
  t.device.pass_s(100);
  t.device.exception = -1;
  EXPECT_EQ(t.driver->refresh(), Status::kTimeout);
  t.device.exception = 0;
  t.device.set(10, {0});
  EXPECT_FALSE(t.reading().order_replaced || t.measured.order_ended);
}

TEST_F(DriverTest, NothingOfAnOrderIsWrittenAfterItsTime) {
  MapUnderTest& t = with();
  ASSERT_EQ(t.read(), Status::kOk);
  // The process is stopped before the second write leaves, and continues twenty minutes later.
  int requests = 0;
  t.device.before_request = [&] {
    if (++requests == 2) t.device.pass_s(1'200);
  };
  const PowerOrder order{.power_w = 1'000,
                         .soc_max_e4 = 9'000,
                         .duration_s = 300,
                         .write_until_ns = t.device.now_ns + 60'000'000'000};
  EXPECT_EQ(t.driver->order(order), Status::kTooLate);
  // The first write's half is taken back; the second was never sent.
  for (const WriteRecord& write : t.device.take_writes()) {
    if (write.address == 10) {
      EXPECT_EQ(write.values, std::vector<int>{0});
    }
  }
  EXPECT_EQ(t.device.holding[10], 0);
}

TEST_F(DriverTest, ARetryAfterItsTimeIsNotMade) {
  MapUnderTest& t = with();
  ASSERT_EQ(t.read(), Status::kOk);
  t.device.failing_writes = 1;
  t.device.before_request = [&] {
    if (t.device.failing_writes == 0) t.device.pass_s(1'200);
  };
  const PowerOrder order{
      .power_w = 1'000, .duration_s = 300, .write_until_ns = t.device.now_ns + 60'000'000'000};
  EXPECT_EQ(t.driver->order(order), Status::kTooLate);
  EXPECT_EQ(t.device.holding[11], 0);
}

TEST_F(DriverTest, AnOrderOfYesterdayIsNotFed) {
  MapUnderTest& t = with();
  PowerOrder order{.power_w = 1'000, .duration_s = 300};
  order.feed_until_ns = t.device.now_ns + 200'000'000'000;
  ASSERT_EQ(t.driver->order(order), Status::kOk);
  t.device.pass_s(100);
  EXPECT_EQ(t.driver->refresh(), Status::kOk);
  t.device.take_writes();
  t.device.pass_s(1'200);
  EXPECT_EQ(t.driver->refresh(), Status::kTooLate);
  EXPECT_THAT(t.device.take_writes(), IsEmpty());
}

TEST_F(DriverTest, BehindANewConnectionTheDeviceIsProvedAgain) {
  MapUnderTest& t = with_order(kIdentity);
  t.device.set(20, {8});
  ASSERT_EQ(t.read(), Status::kOk);  // known
  ++t.device.reconnects;
  EXPECT_EQ(t.read(), Status::kImplausible);
  t.device.take_writes();
  EXPECT_EQ(t.order(2'000), Status::kImplausible);
  t.device.set(20, {7});
  EXPECT_EQ(t.read(), Status::kOk);
}

TEST_F(DriverTest, TheDeviceIsProvedAgainEveryTenMinutes) {
  MapUnderTest& t = with(kIdentity);
  ASSERT_EQ(t.read(), Status::kOk);
  t.device.set(20, {8});
  t.device.pass_s(599);
  EXPECT_EQ(t.read(), Status::kOk);
  t.device.pass_s(2);
  EXPECT_EQ(t.read(), Status::kImplausible);
}

TEST_F(DriverTest, AKnownDeviceIsReleasedDespiteAFailedCheck) {
  MapUnderTest& t = with_order(kIdentity);
  t.device.set(20, {8});
  ++t.device.reconnects;
  EXPECT_EQ(t.driver->release(), Status::kOk);
  EXPECT_EQ(t.device.holding[10], 0);
}

TEST_F(DriverTest, AForeignOrderIsReleasedOnlyOnRequest) {
  MapUnderTest& t = with(kIdentity);
  t.device.set(20, {8});
  EXPECT_EQ(t.driver->release(), Status::kImplausible);
  EXPECT_THAT(t.device.take_writes(), IsEmpty());
  t.driver->permit_release();
  EXPECT_EQ(t.driver->release(), Status::kOk);
}

TEST_F(DriverTest, ARestartSeesWhatIsInForce) {
  MapUnderTest& t = with();
  t.device.set(10, {1, 0xF830, 300});
  EXPECT_TRUE(t.reading().dispatch_active);
  EXPECT_TRUE(t.measured.has_order_power);
  EXPECT_EQ(t.measured.order_power_w, -2'000);
}

TEST_F(DriverTest, AcknowledgedButNotDoneEndsInARollBack) {
  MapUnderTest& t = with();
  ASSERT_EQ(t.read(), Status::kOk);
  t.device.ignores_writes = true;
  EXPECT_EQ(t.order(1'000), Status::kNotApplied);
  const std::vector<WriteRecord> writes = t.device.take_writes();
  ASSERT_GE(writes.size(), 5U);  // two attempts, then the release
  EXPECT_EQ(writes[4], (WriteRecord{1, 16, 10, {0}}));
}

TEST_F(DriverTest, HalfACommandIsWithdrawn) {
  MapUnderTest& t = with();
  ASSERT_EQ(t.read(), Status::kOk);
  t.device.exception = 2;  // final: no second attempt
  EXPECT_EQ(t.order(1'000), Status::kBusException);
  // The order's first, the release by both functions that write a single register.
  EXPECT_THAT(t.device.take_writes(), SizeIs(3));
}

TEST_F(DriverTest, ADroppedConnectionIsRestoredWithinTheCycle) {
  MapUnderTest& t = with();
  ASSERT_EQ(t.read(), Status::kOk);
  t.device.failing_writes = 1;
  EXPECT_EQ(t.order(1'000), Status::kOk);
  EXPECT_EQ(t.device.holding[10], 1);
}

TEST_F(DriverTest, ReadBackWithToleranceAndWithout) {
  MapUnderTest& t = with({{"order = [[\"power = power\", \"time = duration\"],",
                           "order = [{ write = \"power = power\", read_back = \"tolerance\", "
                           "tolerance = 50 }, { write = \"time = duration\", read_back = "
                           "\"none\" },"}});
  t.device.after_write = [&](int address, int) {
    if (address == 11) t.device.holding[11] -= 50;  // the device clamps
    if (address == 12) t.device.holding[12] = 0;
  };
  EXPECT_EQ(t.order(1'000), Status::kOk);
  t.device.after_write = [&](int address, int) {
    if (address == 11) t.device.holding[11] -= 51;
  };
  EXPECT_EQ(t.order(2'000), Status::kNotApplied);
}

TEST_F(DriverTest, FlashIsWrittenOnlyWhenItChangesAndOnlyWithinTheBudget) {
  MapUnderTest& t = with({{"order = [[",
                           "idle = [\"enable = 1\", \"time = duration\"]\n"
                           "discharge = [\"mode = 2\", \"time = duration\", "
                           "\"enable = 1\"]\ncharge = [\"mode = 1\", "
                           "\"time = duration\", \"enable = 1\"]\n#"},
                          {"release = [", "release = [\"mode = 0\", "}});
  t.device.set(20, {1});
  ASSERT_EQ(t.order(1'000), Status::kOk);  // it is 1 already: read, not written
  EXPECT_EQ(t.driver->counters().flash_writes_today, 0);
  for (const int power_w : {-1'000, 1'000, -1'000, 1'000}) {
    ASSERT_EQ(t.order(power_w), Status::kOk);
  }
  EXPECT_EQ(t.driver->counters().flash_writes_today, 4);
  t.device.take_writes();
  EXPECT_EQ(t.order(-1'000), Status::kWriteBudget);
  EXPECT_THAT(t.device.writes, IsEmpty());  // not even the half without flash cost
  ASSERT_EQ(t.order(1'000), Status::kOk);   // in force: costs nothing
  ASSERT_EQ(t.driver->release(), Status::kOk);
  EXPECT_EQ(t.driver->counters().flash_writes_today, 5);
  ++t.device.day;
  EXPECT_EQ(t.driver->counters().flash_writes_today, 0);
  EXPECT_EQ(t.order(-1'000), Status::kOk);
}

TEST_F(DriverTest, TheBudgetOfADaySurvivesARestart) {
  MapUnderTest& t = with({{"order = [[", "order = [\"mode = 1\", ["}});
  t.driver->restore_flash_writes(t.device.day, 4);
  EXPECT_EQ(t.order(1'000), Status::kWriteBudget);
  t.driver->restore_flash_writes(t.device.day - 1, 4);
  EXPECT_EQ(t.order(1'000), Status::kOk);
}

TEST_F(DriverTest, ARefusedOrderEndsTheRefreshOfThePreviousOne) {
  MapUnderTest& t = with({{"refresh_s = 120", "refresh_s = 30"},
                          {"order = [[",
                           "idle = [\"enable = 1\", \"time = duration\"]\n"
                           "discharge = [\"mode = 2\", \"power = power\", \"time = duration\", "
                           "\"enable = 1\"]\ncharge = [\"power = power\", "
                           "\"time = duration\", \"enable = 1\"]\n#"}});
  t.driver->restore_flash_writes(t.device.day, 4);
  ASSERT_EQ(t.order(1'000), Status::kOk);
  t.device.take_writes();
  ASSERT_EQ(t.order(-1'000), Status::kWriteBudget);
  t.device.pass_s(30);
  EXPECT_THAT(t.refresh_writes(), IsEmpty());  // charging ends with its timer
}

TEST_F(DriverTest, AnOrderThatCannotBeSentEndsTheRefreshOfThePreviousOne) {
  MapUnderTest& t = with({{"refresh_s = 120", "refresh_s = 30"},
                          {"name = \"power\"", "name = \"power\", clamp_to = \"battery_power\""}});
  t.device.set(1, {1'000});
  ASSERT_EQ(t.order(1'000), Status::kOk);
  t.device.pass_s(181);  // the limits are too old, and the link is down
  t.device.exception = -1;
  ASSERT_EQ(t.order(0), Status::kTimeout);
  t.device.exception = 0;  // it is back before the next control cycle
  t.device.take_writes();
  EXPECT_THAT(t.refresh_writes(), IsEmpty());
}

TEST_F(DriverTest, WithoutAWatchdogARefusedOrderWithdrawsThePreviousOne) {
  MapUnderTest& t =
      with_order({{"kind = \"duration\"\nduration_s = 300\nrefresh_s = 120", "kind = \"none\""}});
  ASSERT_EQ(t.order(10'001), Status::kNotExpressible);
  EXPECT_EQ(t.device.holding[10], 0);
}

/// A register that cannot be restored is retried every control cycle of the safe state, for months.
TEST_F(DriverTest, ReleasesThatFailDoNotWearTheFlashBeyondItsDay) {
  MapUnderTest& t = with({{"release = [", "release = [\"mode = 0\", \"enable = 0\"] #"}});
  t.device.set(20, {1});
  ASSERT_EQ(t.order(1'000), Status::kOk);
  t.device.after_write = [&](int address, int) {
    if (address == 20) t.device.set(20, {1});
  };
  for (int cycle = 0; cycle < 20; ++cycle) {
    t.device.set(10, {1});
    EXPECT_NE(t.driver->release(), Status::kOk);
    EXPECT_EQ(t.device.holding[10], 0);  // writes without flash cost are still made
  }
  EXPECT_EQ(t.driver->counters().flash_writes_today, 5);
  ++t.device.day;
  t.device.after_write = [](int, int) {};
  EXPECT_EQ(t.driver->release(), Status::kOk);
}

TEST_F(DriverTest, EnableHappensOnceAndWhatItChangedIsRestored) {
  MapUnderTest& t = with({{"release = [",
                           "save = [\"mode = 5\"]\nenable = [\"mode = 9\"]\n"
                           "precondition = [\"status = ready\"]\nrelease = [\"mode = saved\", "}});
  t.device.set(20, {3, 0});
  EXPECT_EQ(t.order(1'000), Status::kNotPermitted);
  EXPECT_THAT(t.device.writes, IsEmpty());
  t.device.set(21, {7});
  ASSERT_EQ(t.order(1'000), Status::kOk);
  ASSERT_EQ(t.order(2'000), Status::kOk);
  EXPECT_EQ(t.device.holding[20], 9);
  ASSERT_EQ(t.driver->release(), Status::kOk);
  EXPECT_EQ(t.device.holding[20], 3);
  // Found in force at start: the register holds what an earlier process wrote.
  t.device.set(10, {1});
  t.device.set(20, {9});
  MapUnderTest& restarted = *test_;
  DeviceDriver successor(restarted.map, DeviceClock(t.device), -1, t.device);
  ASSERT_EQ(successor.order({.power_w = 500, .duration_s = 300}), Status::kOk);
  ASSERT_EQ(successor.release(), Status::kOk);
  EXPECT_EQ(t.device.holding[20], 5);
}

TEST_F(DriverTest, AShortenedTimerIsRefreshedImmediately) {
  MapUnderTest& t =
      with({{"refresh_s = 120", "refresh_s = 120\nremaining = \"status\""},
            {"names = { busy = 0, ready = 7 }, min = 0, max = 9", "min = 0, max = 999"}});
  t.device.set(21, {300});
  ASSERT_EQ(t.order(1'000), Status::kOk);
  t.device.take_writes();
  ASSERT_EQ(t.read(), Status::kOk);
  EXPECT_THAT(t.refresh_writes(), IsEmpty());
  t.device.set(21, {100});  // another program wrote a shorter time
  ASSERT_EQ(t.read(), Status::kOk);
  EXPECT_THAT(t.refresh_writes(), SizeIs(2));
}

TEST_F(DriverTest, ImplausibleValuesAreNeverUsedAndSlowOnesAreNotReadAgain) {
  MapUnderTest& t = with({{"scale = 100", "scale = 100, max_age_s = 600"}});
  EXPECT_EQ(t.reading().soc_e4, 5'000);
  t.device.set(0, {60});
  t.device.pass_s(599);
  EXPECT_EQ(t.reading().soc_e4, 5'000);
  t.device.pass_s(2);
  EXPECT_EQ(t.reading().soc_e4, 6'000);
  t.device.set(0, {104});
  t.device.pass_s(601);
  EXPECT_EQ(t.reading().soc_e4, 10'000);
  EXPECT_EQ(t.measured.cut_point, 1);
  t.device.set(0, {106});
  t.device.pass_s(601);
  EXPECT_EQ(t.read(), Status::kImplausible);
  EXPECT_EQ(t.driver->release(), Status::kOk);  // a release is still possible
}

TEST_F(DriverTest, FailingMeasurementsDoNotKeepFromHoldingAndReleasing) {
  MapUnderTest& t = with_order();
  t.device.unreadable_address = 0;
  t.device.pass_s(1'000);
  EXPECT_EQ(t.read(), Status::kTimeout);
  EXPECT_EQ(t.order(0), Status::kOk);
  EXPECT_EQ(t.device.holding[11], 0);
  EXPECT_EQ(t.driver->release(), Status::kOk);
  EXPECT_EQ(t.device.holding[10], 0);
}

TEST_F(DriverTest, OldLimitsDoNotGoIntoAnOrderButIntoARelease) {
  MapUnderTest& t = with({{"name = \"power\"", "name = \"power\", clamp_to = \"battery_power\""}});
  t.device.set(1, {500});
  ASSERT_EQ(t.order(1'000), Status::kOk);
  EXPECT_EQ(t.device.holding[11], 500);
  t.device.unreadable_address = 0;
  t.device.pass_s(1'000);
  EXPECT_EQ(t.order(2'000), Status::kTimeout);
  EXPECT_EQ(t.driver->release(), Status::kOk);
}

TEST_F(DriverTest, ReadingNeverWrites) {
  MapUnderTest& t = with();
  IdentityFailure failure;
  ASSERT_EQ(t.driver->check_identity(failure), Status::kOk);
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(t.read(), Status::kOk);
    ASSERT_EQ(t.driver->refresh(), Status::kOk);
    t.device.pass_s(120);
  }
  EXPECT_THAT(t.device.writes, IsEmpty());
}

TEST_F(DriverTest, HeartbeatsDifferAndWrapWithinTheirRange) {
  MapUnderTest& t = with({{"kind = \"duration\"", "kind = \"heartbeat\""},
                          {"order = [[",
                           "order = [{ write = \"mode = heartbeat\", read_back = "
                           "\"none\" }, ["},
                          {"storage = \"eeprom\", ", ""}});
  std::vector<int> beats;
  for (int i = 0; i < 12; ++i) {
    ASSERT_EQ(t.order(1'000), Status::kOk);
    beats.push_back(t.device.holding[20]);
    t.device.pass_s(120);
  }
  for (std::size_t i = 1; i < beats.size(); ++i) EXPECT_EQ(beats[i], (beats[i - 1] + 1) % 10);
}

TEST_F(DriverTest, PowerBeyondTheMapIsRefusedWithoutAWrite) {
  MapUnderTest& t = with();
  EXPECT_EQ(t.order(10'001), Status::kNotExpressible);
  EXPECT_EQ(t.order(-10'001), Status::kNotExpressible);
  EXPECT_THAT(t.device.writes, IsEmpty());
  ASSERT_EQ(t.order(1'000), Status::kOk);
  t.device.take_writes();
  EXPECT_EQ(t.order(10'001), Status::kNotExpressible);
  EXPECT_THAT(t.device.writes, IsEmpty()) << "the timer ends the previous order";
}

}  // namespace
}  // namespace bess
