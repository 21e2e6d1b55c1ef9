// Register map check against recorded answers: each kind of mistake is named, with the value that
// would fit.
#include "edge/app/recording/map_check.h"

#include <gmock/gmock.h>

#include "edge/device/registers/map_file.h"
#include "shared/scaled_clock.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A battery of 8 kWh: SoC at 0 in 0.1 %, power at 1 (+ charge), capacity at 2 in two registers
/// (Wh), the order at 10.
constexpr const char* kPlainMap = R"(
map = { name = "plain", unit = 1 }
power = { charge_w_max = 30000, discharge_w_max = 30000 }
watchdog = { kind = "duration", duration_s = 300, refresh_s = 120 }
response = { settle_s = 20 }
identity = [{ point = "soc", min = 0, max = 10000, hint = "is this the battery?" }]
point = [
  { name = "soc", address = 0, scale = 10, min = 0, max = 10000 },
  { name = "battery_power", address = 1, type = "s16", min = -30000, max = 30000 },
  { name = "capacity", address = 2, type = "u32", min = 1000, max = 2000000 },
  { name = "start", address = 10, min = 0, max = 1 },
  { name = "order", address = 11, type = "s16", min = -30000, max = 30000 },
  { name = "seconds", address = 12, min = 0, max = 65535 },
]

[state]
measure = ["soc", "battery_power", "capacity"]
active = ["start"]
order_power = [{ power = "order" }]

[command]
charge = [["start = 1", "order = power", "seconds = duration"]]
idle = [["start = 1", "order = power", "seconds = duration"]]
discharge = [["start = 1", "order = power", "seconds = duration"]]
release = ["start = 0"]
)";

/// Behaviour of a device with that map on the bus.
class MapCheckTest : public ::testing::Test {
 protected:
  void load(const std::string& from = "", const std::string& to = "") {
    std::string text = kPlainMap;
    if (!from.empty()) {
      ASSERT_NE(text.find(from), std::string::npos) << from;
      text.replace(text.find(from), from.size(), to);
    }
    std::string error;
    ASSERT_TRUE(load_register_map(folder_.write("map.toml", text), "", map_, error)) << error;
    check_ = std::make_unique<MapCheck>(map_, -1);
  }
  /// At the present time.
  void add(std::uint8_t function, std::uint16_t address, std::vector<int> values,
           BusOutcome outcome = BusOutcome::kAnswered, int exception = 0) {
    BusExchange exchange{.utc_ns = utc_s_ * kNanosecondsPerSecond,
                         .unit = 1,
                         .function = function,
                         .outcome = outcome,
                         .exception = exception,
                         .address = address,
                         .count = static_cast<std::uint16_t>(values.size())};
    std::copy(values.begin(), values.end(), exchange.registers.begin());
    check_->add(exchange);
  }
  /// 90 min of alternating charge and discharge, read every 10 s. `gain`: SoC against power.
  void drive(double gain = 1, int power_sign = 1) {
    double soc_permille = 500;
    for (int turn = 0; turn < 6; ++turn) {
      const int order_w = turn % 2 == 0 ? 4'000 : -4'000;
      add(16, 10, {1, order_w & 0xFFFF, 300});
      for (int i = 0; i < 90; ++i) {
        utc_s_ += 10;
        soc_permille += gain * order_w * 10 / 3'600.0 / 8'000 * 1'000;
        const int power_w = power_sign * order_w;
        add(3, 0, {static_cast<int>(std::lround(soc_permille)), power_w & 0xFFFF, 0, 8'000});
        add(3, 10, {1, order_w & 0xFFFF, 300});
      }
    }
  }
  std::string finding(const std::string& name) const {
    for (const PointVerdict& point : check_->verdicts()) {
      if (point.name == name) return point.finding;
    }
    return "there is no point " + name;
  }
  /// Of the points with a finding.
  std::string named() const {
    std::string names;
    for (const PointVerdict& point : check_->verdicts()) {
      if (!point.finding.empty()) names += (names.empty() ? "" : " ") + std::string(point.name);
    }
    return names;
  }
  /// Every finding, "NAME: what".
  std::string findings() const {
    std::string text;
    for (const PointVerdict& point : check_->verdicts()) {
      if (!point.finding.empty()) text += point.name + ": " + point.finding + "\n";
    }
    return text;
  }

  TemporaryFolder folder_;
  RegisterMap map_;
  std::unique_ptr<MapCheck> check_;
  std::int64_t utc_s_ = 1'679'788'800;
};

TEST_F(MapCheckTest, ARightMapHasNoFindings) {
  load();
  drive();
  EXPECT_EQ(findings(), "");
  EXPECT_EQ(check_->unjudged(), "");
  const std::vector<PointVerdict> points = check_->verdicts();
  EXPECT_EQ(points[1].address, 1);
  EXPECT_EQ(points[1].value_min, -4'000);
  EXPECT_EQ(points[1].value_max, 4'000);
  EXPECT_EQ(points[1].answers, 540);
}

TEST_F(MapCheckTest, AnOrderOfTheWrongSignIsAnotherFinding) {
  load("address = 11, type = \"s16\"", "address = 11, type = \"s16\", sign = -1");
  drive();
  EXPECT_THAT(findings(), HasSubstr("order: "));
  EXPECT_EQ(finding("battery_power"), "");
}

TEST_F(MapCheckTest, AWrongMapOrDeviceIsNamedByItsPoint) {
  struct Case {
    const char *from, *to;
    const char *named, *codes;
    double gain = 1;
    int power_sign = 1;
  };
  for (const Case& c : {Case{"", "", "battery_power", "sign", 1, -1},
                        Case{"type = \"s16\"", "type = \"s16\", scale_divisor = 10",
                             "battery_power", "10 scale soc capacity"},
                        Case{"scale = 10,", "scale = 1,", "soc", "10th scale capacity"},
                        Case{"", "", "soc", "5978 Wh", 0}}) {
    SCOPED_TRACE(c.codes);
    load(c.from, c.to);
    drive(c.gain, c.power_sign);
    EXPECT_EQ(named(), c.named);
    EXPECT_THAT(findings(), Names(c.codes));
  }
}

TEST_F(MapCheckTest, ValuesOutsideTheirRangeAreNamedWithWhatWouldFit) {
  load("scale = 10,", "scale = 100,");
  add(3, 0, {435, 0, 0, 8'000});
  EXPECT_THAT(finding("soc"), Names("43500 [435] 0 10000 1 scale 10"));
  load("type = \"u32\"", "type = \"u32\", word_order = \"low_first\"");
  add(3, 0, {435, 0, 0, 8'000});
  EXPECT_THAT(finding("capacity"),
              Names("524288000 [0 8000] 1000 2000000 1 word_order = \"high_first\""));
  load("type = \"s16\"", "type = \"u16\"");
  add(3, 0, {435, 0xF060, 0, 8'000});
  EXPECT_THAT(finding("battery_power"), Names("61536 [61536] -30000 30000 1 type = \"s16\""));
}

TEST_F(MapCheckTest, WhatWasNeverAnsweredIsNamed) {
  load();
  add(3, 0, {435});
  add(3, 1, {0}, BusOutcome::kException, 2);
  EXPECT_EQ(finding("soc"), "");
  EXPECT_EQ(named(), "battery_power capacity start order");
  EXPECT_THAT(finding("battery_power"), Names("exception 2"));
  const std::string never_asked = finding("capacity");
  EXPECT_EQ(finding("seconds"), "") << "it is only written";
  add(3, 2, {0, 0}, BusOutcome::kTimeout);
  EXPECT_THAT(finding("capacity"), AllOf(Names("1"), testing::Ne(never_asked)));
}

TEST_F(MapCheckTest, AFailedIdentityCheckIsReportedWithItsHint) {
  load("min = 0, max = 10000, hint", "min = 5000, max = 10000, hint");
  add(3, 0, {435, 0, 0, 8'000});
  EXPECT_THAT(finding("soc"), AllOf(Names("4350"), HasSubstr("is this the battery?")));
}

TEST_F(MapCheckTest, WhatCannotBeJudgedIsSaid) {
  load();
  for (int i = 0; i < 100; ++i, utc_s_ += 10) {
    add(3, 0, {435, 0, 0, 8'000});
    add(3, 10, {0, 0, 0});
  }
  EXPECT_EQ(findings(), "");
  EXPECT_NE(check_->unjudged(), "");
}

TEST_F(MapCheckTest, AGapOfTheRecordingIsNoEnergy) {
  load();
  drive();
  utc_s_ += 86'400;  // full of unobserved values
  drive();
  EXPECT_EQ(findings(), "");
}

}  // namespace
}  // namespace bess
