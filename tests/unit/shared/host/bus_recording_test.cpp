// Device recordings as files: written data is read back, and truncated or damaged data is one line
// that names file and line.
#include "shared/host/bus_recording.h"

#include <gmock/gmock.h>

#include <cstring>

#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::ElementsAre;
using Next = BusRecordingReader::Next;

const RecordingHead kHead{.version = "0.1.0",
                          .map = "sma",
                          .variant = "setpoint",
                          .unit = 3,
                          .units = {{"vebus", 227}},
                          .rtu = true,
                          .begin_utc_s = 1'679'788'800,
                          .time_scale = 60};
constexpr const char* kRead =
    R"({"utc":"2023-03-26T00:00:01.000250Z","unit":3,"function":3,"address":258,"count":2,"latency_us":8120,"values":[435,65535]})";
constexpr const char* kRefused =
    R"({"utc":"2023-03-26T00:00:02Z","unit":3,"function":4,"address":9,"count":1,"latency_us":1,"exception":2})";
constexpr const char* kSilence =
    R"({"utc":"2023-03-26T00:00:03Z","unit":3,"function":3,"address":9,"count":1,"latency_us":1,"error":"timeout"})";
constexpr const char* kLostWrite =
    R"({"utc":"2023-03-26T00:00:04Z","unit":3,"function":6,"address":9,"count":1,"latency_us":1,"error":"not_connected","values":[7]})";
constexpr const char* kEndOfFour = R"({"end":"2023-03-26T00:00:05Z","exchanges":4,"dropped":1})";

class BusRecording : public ::testing::Test {
 protected:
  std::string write(const std::vector<std::string>& lines) const {
    std::string text = format_recording_head(kHead) + "\n";
    for (const std::string& line : lines) text += line + "\n";
    return folder_.write("device.jsonl", text);
  }
  /// Reads to the end; returns the error, empty if there is none.
  std::string read(const std::string& path, CutRecording cut = CutRecording::kRefused) {
    exchanges_.clear();
    std::string error;
    if (!reader_.emplace().open(path, cut, error)) return error;
    BusExchange exchange;
    auto next = reader_->next(exchange, error);
    for (; next == Next::kExchange; next = reader_->next(exchange, error)) {
      exchanges_.push_back(exchange);
    }
    EXPECT_EQ(error.empty(), next == Next::kEnd);
    return error;
  }
  std::string damage(const std::string& line) { return read(write({kRead, line, kEndOfFour})); }

  TemporaryFolder folder_;
  std::optional<BusRecordingReader> reader_;
  std::vector<BusExchange> exchanges_;
};

TEST_F(BusRecording, IsReadAsItWasWritten) {
  ASSERT_EQ(read(write({kRead, kRefused, kSilence, kLostWrite, kEndOfFour})), "");
  ASSERT_EQ(exchanges_.size(), 4U);
  EXPECT_EQ(exchanges_[0].utc_ns, 1'679'788'801'000'250'000);
  EXPECT_EQ(exchanges_[0].latency_us, 8'120);
  EXPECT_THAT(exchanges_[0].values(), ElementsAre(435, 65'535));
  EXPECT_EQ(exchanges_[1].outcome, BusOutcome::kException);
  EXPECT_EQ(exchanges_[1].exception, 2);
  EXPECT_EQ(exchanges_[2].outcome, BusOutcome::kTimeout);
  EXPECT_TRUE(exchanges_[2].values().empty());
  EXPECT_EQ(exchanges_[3].outcome, BusOutcome::kNotConnected);
  EXPECT_THAT(exchanges_[3].values(), ElementsAre(7));
  EXPECT_EQ(reader_->dropped(), 1);
  EXPECT_FALSE(reader_->was_cut());
  const RecordingHead& head = reader_->head();
  EXPECT_EQ(head.map, "sma");
  EXPECT_EQ(head.variant, "setpoint");
  EXPECT_EQ(head.unit, 3);
  EXPECT_EQ(head.units, kHead.units);
  EXPECT_TRUE(head.rtu);
  EXPECT_EQ(head.begin_utc_s, kHead.begin_utc_s);
  EXPECT_EQ(head.time_scale, 60);
}

TEST_F(BusRecording, CutIsOneLineWithItsNumberAndIsAcceptedOnRequest) {
  const std::string path = write({kRead, kRefused});
  EXPECT_THAT(read(path), Names("device.jsonl:4 --accept-cut 2"));
  EXPECT_EQ(read(path, CutRecording::kAccepted), "");
  EXPECT_TRUE(reader_->was_cut());
  EXPECT_EQ(exchanges_.size(), 2U);
}

TEST_F(BusRecording, CutWithinALineIsTheSame) {
  const std::string whole = write({kRead, kRefused});
  std::filesystem::resize_file(whole, std::filesystem::file_size(whole) - 20);
  EXPECT_THAT(read(whole), Names("device.jsonl:3 --accept-cut 1"));
  EXPECT_EQ(read(whole, CutRecording::kAccepted), "");
  EXPECT_EQ(exchanges_.size(), 1U);
}

TEST_F(BusRecording, DamageIsOneLineWithItsNumber) {
  const auto changed = [](std::string from, std::string to) {
    std::string line = kRead;
    return line.replace(line.find(from), from.size(), to);
  };
  const std::string values = "\"values\":[435,65535]";
  const std::pair<std::string, const char*> cases[] = {
      {"}{", ""},
      {"", ""},
      {std::string(5'000, 'x'), ""},
      {changed("00:01.000250Z", "00:01"), "\"utc\""},
      {changed("\"unit\":3", "\"unit\":300"), "\"unit\" 255"},
      {changed("\"function\":3", "\"function\":5"), "\"function\""},
      {changed("258", "-1"), "\"address\" 65535"},
      {changed("\"count\":2", "\"count\":126"), "\"count\" 125"},
      {changed("\"address\":258", "\"address\":65535"), "\"address\" \"count\" 65536"},
      {changed("\"count\":2", "\"count\":3"), "\"values\""},
      {changed("65535", "65536"), "\"values\""},
      {changed("8120", "-8"), "\"latency_us\""},
      {changed(values, "\"error\":\"gone\""), "\"exception\" \"error\""},
      {changed(values, "\"exception\":0"), "\"exception\" \"error\""}};
  for (const auto& [line, names] : cases) {
    EXPECT_THAT(damage(line), Names("device.jsonl:3 " + std::string(names))) << line;
  }
}

TEST_F(BusRecording, MissingLinesShowInTheCount) {
  EXPECT_THAT(read(write({kRead, kRefused, kSilence, kEndOfFour})), Names("device.jsonl:5 4 3"));
  EXPECT_THAT(read(write({kRead, kRefused, kSilence, kLostWrite, kEndOfFour, kRead})),
              Names("device.jsonl:7"));
}

TEST_F(BusRecording, AnythingElseIsNoRecording) {
  EXPECT_THAT(read(folder_.write("a.jsonl", "")), Names("a.jsonl:1"));
  EXPECT_THAT(read(folder_.write("b.csv", "minute_utc,soc\n")), Names("b.csv:1"));
  EXPECT_THAT(read(folder_.write("c.jsonl", R"({"bess_recording":2})"
                                            "\n")),
              Names("c.jsonl:1"));
  EXPECT_THAT(read(folder_.file("none.jsonl")),
              Names("none.jsonl " + std::string(std::strerror(ENOENT))));
}

}  // namespace
}  // namespace bess
