// Required readings: a protective reading that a device has had once stays required; whatever loses
// it, whenever and however long, the battery is not driven as if nothing was wrong.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "tests/support/image_device.h"

namespace bess {
namespace {

constexpr int kBatteryAlarm = 267;
constexpr int kActiveInput = 29;

/// A gateway that answers for an absent unit, or is busy, for some seconds.
TEST(RequiredReading, IsAskedForAgainWhileTheTroubleMayPass) {
  for (const int exception : {5, 6, 10, 11, -1}) {
    MapUnderTest t(shipped_map("victron_ess3"), fill_victron);
    ASSERT_EQ(t.read(), Status::kOk);
    t.device.missing = {{.address = kBatteryAlarm, .exception = exception}};
    t.device.set(kBatteryAlarm, {2});
    const std::int64_t end_ns = t.device.now_ns + 8'000'000'000;
    t.device.before_request = [&] {
      if (t.device.now_ns >= end_ns) t.device.missing.clear();
    };
    EXPECT_EQ(t.reading().lost_point, 0) << exception;
    EXPECT_TRUE(t.measured.alarm) << exception;
  }
}

TEST(RequiredReading, OneThatStaysAwayIsNamed) {
  for (const int exception : {2, 4, 6, 10, 11, -1}) {
    MapUnderTest t(shipped_map("victron_ess3"), fill_victron);
    ASSERT_EQ(t.read(), Status::kOk);
    t.device.missing = {{.address = kBatteryAlarm, .exception = exception}};
    const std::int64_t start_ns = t.device.now_ns;
    EXPECT_EQ(t.reading().lost_point, 1 + find_point(t.map, "battery_alarm")) << exception;
    EXPECT_FALSE(t.measured.grid_unknown) << exception;
    EXPECT_EQ(t.measured.soc_e4, 6'200) << exception;
    EXPECT_LE(t.device.now_ns - start_ns, 25'000'000'000) << exception;
    t.device.pass_s(3'600);  // identified again in between: it is not forgotten
    EXPECT_NE(t.reading().lost_point, 0) << exception;
    t.device.missing.clear();
    EXPECT_EQ(t.reading().lost_point, 0) << exception;
  }
}

TEST(RequiredReading, TheGridIsUnknownWithoutItsRegister) {
  MapUnderTest t(shipped_map("victron_ess3"), fill_victron);
  ASSERT_EQ(t.read(), Status::kOk);
  t.device.missing = {{.address = kActiveInput, .exception = 10}};
  EXPECT_TRUE(t.reading().grid_unknown);
  EXPECT_FALSE(t.measured.off_grid);
}

TEST(RequiredReading, OfAnEarlierRunIsRequiredFromTheStart) {
  MapUnderTest t(shipped_map("victron_ess3"), fill_victron);
  const int alarm = find_point(t.map, "battery_alarm");
  t.driver->require(static_cast<std::int8_t>(alarm));
  t.device.missing = {{.address = kBatteryAlarm, .exception = 11}};
  EXPECT_EQ(t.reading().lost_point, 1 + alarm);
}

TEST(RequiredReading, ThatTurnsNotImplementedIsLost) {
  MapUnderTest t(shipped_map("victron_ess3"), fill_victron);
  ASSERT_EQ(t.read(), Status::kOk);
  t.device.set(kBatteryAlarm, {0xFFFF});
  EXPECT_NE(t.reading().lost_point, 0);
}

/// Any protective point of any map, by any exception or silence, at any moment, from half a second
/// to permanently.
class LostReadings : public ::testing::TestWithParam<MapVariant> {};

constexpr std::int64_t kSecondNs = 1'000'000'000;

struct Loss {
  int function, address, exception;
  std::int64_t begin_ns, end_ns;
  [[nodiscard]] bool covers(std::int64_t from_ns, std::int64_t to_ns) const {
    return begin_ns <= from_ns && to_ns < end_ns;
  }
  [[nodiscard]] bool touches(std::int64_t from_ns, std::int64_t to_ns) const {
    return begin_ns <= to_ns && from_ns < end_ns;
  }
};

TEST_P(LostReadings, StopOrCome) {
  std::mt19937 random(520'001);
  const auto draw = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  constexpr int kExceptions[] = {1, 2, 3, 4, 5, 6, 10, 11, -1};
  int lost = 0;
  for (int trial = 0; trial < 60; ++trial) {
    SimulatedDevice simulated(GetParam().map, GetParam().variant);
    MapUnderTest& t = simulated.test;
    ASSERT_EQ(t.read(), Status::kOk);
    if (t.map.protective.empty()) return;
    const std::int8_t point = t.map.protective[draw(0, t.map.protective.size() - 1)];
    if (t.driver->live().absent[point]) continue;
    const PlacedPoint placed = t.driver->place_of(point);
    const std::int64_t begin_ns = t.device.now_ns + draw(0, 240'000) * (kSecondNs / 1'000);
    const int kind = draw(0, 2);
    const std::int64_t length_ns = kind == 0   ? draw(500, 20'000) * (kSecondNs / 1'000)
                                   : kind == 1 ? draw(20, 600) * kSecondNs
                                               : INT64_MAX / 2;
    const Loss loss{placed.place.function, placed.place.address,
                    kExceptions[draw(0, std::size(kExceptions) - 1)], begin_ns,
                    begin_ns + length_ns};
    const auto refresh = t.device.before_request;
    t.device.before_request = [&] {
      refresh();
      t.device.missing.clear();
      if (loss.covers(t.device.now_ns, t.device.now_ns)) {
        t.device.missing = {{loss.function, loss.address, loss.exception}};
      }
    };
    for (int tick = 0; tick < 6; ++tick) {
      t.device.pass_s(120);
      const std::int64_t from_ns = t.device.now_ns;
      const bool is_driven = t.read() == Status::kOk && t.measured.lost_point == 0;
      if (loss.covers(from_ns, t.device.now_ns)) {
        EXPECT_FALSE(is_driven) << t.map.points[point].name.c_str() << " " << loss.exception;
        ++lost;
      }
      if (!loss.touches(from_ns, t.device.now_ns)) {
        EXPECT_TRUE(is_driven) << t.map.points[point].name.c_str() << " " << loss.exception;
      }
    }
  }
  EXPECT_GT(lost, 10);
}

INSTANTIATE_TEST_SUITE_P(Shipped, LostReadings, ::testing::ValuesIn(kShippedMapVariants));

}  // namespace
}  // namespace bess
