// Recorded device: it answers as before, by address and time, regardless of milliseconds.
#include "tools/simulators/battery_sim/recorded_device.h"

#include <gmock/gmock.h>

#include "shared/host/user_error.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::ElementsAre;

constexpr std::int64_t kRecordedFromS = 1'679'788'800;

class RecordedDeviceTest : public ::testing::Test {
 protected:
  /// `at_s` after the start; `rest` of the line.
  void record(int at_s, int function, int address, int count, const std::string& rest) {
    text_ += "{\"utc\":\"" + std::string(utc_text(kRecordedFromS + at_s).view()) +
             "\",\"unit\":1,\"function\":" + std::to_string(function) +
             ",\"address\":" + std::to_string(address) + ",\"count\":" + std::to_string(count) +
             ",\"latency_us\":5000," + rest + "}\n";
    ++lines_;
  }
  void load() {
    const std::string path = folder_.write(
        "device.jsonl", format_recording_head({.begin_utc_s = kRecordedFromS}) + "\n" + text_ +
                            "{\"end\":\"2023-03-26T01:00:00Z\",\"exchanges\":" +
                            std::to_string(lines_) + ",\"dropped\":0}\n");
    device_ = std::make_unique<RecordedDevice>(path, CutRecording::kRefused);
  }
  BusExchange ask(double at_s, int function, int address, std::vector<std::uint16_t> values) {
    BusExchange request{.utc_ns = kRecordedFromS * kNanosecondsPerSecond +
                                  static_cast<std::int64_t>(at_s * kNanosecondsPerSecond),
                        .unit = 1,
                        .function = static_cast<std::uint8_t>(function),
                        .address = static_cast<std::uint16_t>(address),
                        .count = static_cast<std::uint16_t>(values.size())};
    std::copy(values.begin(), values.end(), request.registers.begin());
    reported_ = device_->answer(request);
    return request;
  }
  int value_at(double at_s, int address = 10) {
    const BusExchange answer = ask(at_s, 3, address, {0});
    return answer.outcome == BusOutcome::kAnswered ? answer.registers[0] : -answer.exception;
  }

  TemporaryFolder folder_;
  std::string text_;
  int lines_ = 0;
  std::string reported_;
  std::unique_ptr<RecordedDevice> device_;
};

TEST_F(RecordedDeviceTest, TheSameRequestsHaveTheSameAnswersALittleEarlierOrLater) {
  for (int i = 0; i < 10; ++i) record(120 * i, 3, 10, 1, "\"values\":[" + std::to_string(i) + "]");
  for (const double late_s : {-2.0, 0.0, 3.0}) {
    load();
    for (int i = 0; i < 10; ++i) EXPECT_EQ(value_at(120 * i + late_s), i) << late_s;
    EXPECT_EQ(reported_, "");
  }
}

TEST_F(RecordedDeviceTest, AReadBeforeAndOneAfterAnOrderStayApart) {
  for (int i = 0; i < 4; ++i) {
    record(120 * i, 3, 10, 1, "\"values\":[" + std::to_string(2 * i) + "]");
    record(120 * i + 2, 16, 10, 1, "\"values\":[1]");
    record(120 * i + 2, 3, 10, 1, "\"values\":[" + std::to_string(2 * i + 1) + "]");
  }
  load();
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(value_at(120 * i - 1), 2 * i);
    EXPECT_EQ(ask(120 * i, 16, 10, {1}).outcome, BusOutcome::kAnswered);
    EXPECT_EQ(value_at(120 * i + 0.1), 2 * i + 1);
  }
}

TEST_F(RecordedDeviceTest, MoreFrequentReadsRepeatValuesAndRareOnesMissSome) {
  for (int i = 0; i < 10; ++i) record(60 * i, 3, 10, 1, "\"values\":[" + std::to_string(i) + "]");
  load();
  EXPECT_EQ(value_at(0), 0);
  EXPECT_EQ(value_at(20), 0);
  EXPECT_EQ(value_at(35), 0);
  EXPECT_EQ(value_at(60), 1);
  EXPECT_EQ(value_at(400), 6);
  EXPECT_EQ(value_at(9'000), 9);
  EXPECT_EQ(value_at(9'100), 9);
}

TEST_F(RecordedDeviceTest, AnotherSpanOfRegistersIsPutTogether) {
  record(0, 3, 10, 2, "\"values\":[1,2]");
  record(0, 3, 12, 1, "\"values\":[3]");
  record(60, 3, 10, 2, "\"values\":[11,12]");
  load();
  EXPECT_THAT(ask(30, 3, 11, {0, 0}).values(), ElementsAre(2, 3));
  EXPECT_THAT(ask(61, 3, 10, {0, 0, 0}).values(), ElementsAre(11, 12, 3));
  EXPECT_EQ(reported_, "");
}

TEST_F(RecordedDeviceTest, WhatWasNeverRecordedIsExceptionTwoAndOneLine) {
  record(0, 3, 10, 2, "\"values\":[1,2]");
  load();
  BusExchange answer = ask(0, 3, 11, {0, 0});
  EXPECT_EQ(answer.outcome, BusOutcome::kException);
  EXPECT_EQ(answer.exception, 2);
  EXPECT_THAT(reported_, Names("2 11 unit 1 function 3"));
  answer = ask(0, 4, 10, {0});
  EXPECT_EQ(answer.exception, 2) << "an input register is another one";
  answer = ask(0, 6, 10, {5});
  EXPECT_EQ(answer.exception, 2);
  EXPECT_THAT(reported_, Names("10 unit 1 function 6"));
}

TEST_F(RecordedDeviceTest, FailuresAndRefusalsComeBackInTheirTime) {
  record(0, 3, 10, 1, "\"values\":[1]");
  record(120, 3, 10, 1, "\"error\":\"timeout\"");
  record(240, 3, 10, 1, "\"exception\":6");
  record(360, 3, 10, 1, "\"values\":[4]");
  load();
  EXPECT_EQ(value_at(0), 1);
  EXPECT_EQ(ask(121, 3, 10, {0}).outcome, BusOutcome::kTimeout);
  EXPECT_EQ(value_at(241), -6);
  EXPECT_EQ(ask(361, 3, 10, {0}).latency_us, 5'000);
}

TEST_F(RecordedDeviceTest, AWriteOfOtherValuesIsReported) {
  record(0, 16, 10, 2, "\"values\":[1,4000]");
  load();
  EXPECT_EQ(ask(0, 16, 10, {1, 4'000}).outcome, BusOutcome::kAnswered);
  EXPECT_EQ(reported_, "");
  EXPECT_EQ(ask(1, 16, 10, {1, 3'000}).outcome, BusOutcome::kAnswered);
  EXPECT_THAT(reported_, Names("10 unit 1 function 16 [1 3000] 2023-03-26T00:00:00Z [1 4000]"));
}

TEST_F(RecordedDeviceTest, AnEmptyOrDamagedRecordingIsOneLine) {
  EXPECT_THROW(load(), UserError);
  text_ = "nonsense\n";
  EXPECT_THROW(load(), UserError);
}

}  // namespace
}  // namespace bess
