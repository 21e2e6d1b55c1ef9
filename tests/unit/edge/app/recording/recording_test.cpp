// Recording of a device: the mask hides private data, the recorder writes whole lines, stays within
// its size limit and renames at the end.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "edge/app/recording/exchange_recorder.h"
#include "edge/app/recording/recording_mask.h"
#include "edge/device/registers/map_file.h"
#include "tests/support/shipped_maps.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Map of a device with its type and serial number in one text, followed by a meter's number.
constexpr const char* kMap = R"(
map = { name = "talkative", unit = 1, kind = "meter", read_gap_registers_max = 4 }
state = { measure = ["grid_power", "meter_number"], grid_power = "grid_power" }
identity = [{ point = "type_and_serial", text = "X1", hint = "another device" }]
point = [
  { name = "type_and_serial", address = 0, type = "text", registers = 4 },
  { name = "grid_power", address = 10, type = "s16", min = -10000, max = 10000 },
  { name = "meter_number", address = 13, type = "u32", private = true, min = 0, max = 4000000000 },
]
)";

BusExchange reading(std::uint16_t address, std::vector<std::uint16_t> values) {
  BusExchange exchange{.utc_ns = 1'679'788'800'000'000'000,
                       .latency_us = 700,
                       .unit = 1,
                       .address = address,
                       .count = static_cast<std::uint16_t>(values.size())};
  std::copy(values.begin(), values.end(), exchange.registers.begin());
  return exchange;
}

class Recording : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string error;
    ASSERT_TRUE(load_register_map(folder_.write("map.toml", kMap), "", map_, error)) << error;
  }
  std::vector<std::string> lines_of(const std::string& path) const {
    std::ifstream file(path);
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    return lines;
  }
  BusExchange masked(BusExchange exchange) const {
    RecordingMask(map_, -1).apply(exchange);
    return exchange;
  }

  TemporaryFolder folder_;
  RegisterMap map_;
  const RecordingHead head_{.version = "0", .map = "talkative", .begin_utc_s = 1'679'788'800};
  const ScaledClock clock_{.anchor_monotonic_ns = 1, .anchor_utc_s = 1'679'788'800, .scale = 1};
  FileMessage error_;
};

TEST_F(Recording, HidesATextBeyondWhatTheIdentityCheckAsksFor) {
  // "X1S9", "7 \0" -> "X1XX", "X \0": padding is excluded.
  EXPECT_THAT(masked(reading(0, {0x5831, 0x5339, 0x3720, 0x0000})).values(),
              ElementsAre(0x5831, 0x5858, 0x5820, 0x0000));
}

TEST_F(Recording, HidesWhatIsPrivateAndWhatTheMapDoesNotName) {
  EXPECT_THAT(masked(reading(10, {0xFFFE, 11, 12, 0x1234, 0x5678})).values(),
              ElementsAre(0xFFFE, 0, 0, 0, 0));
  EXPECT_THAT(masked(reading(500, {42})).values(), ElementsAre(0));
  BusExchange elsewhere = reading(10, {42});
  elsewhere.unit = 9;
  EXPECT_THAT(masked(elsewhere).values(), ElementsAre(0));
}

TEST(RecordingMask, KeepsTheWalkOverModelsAndTheirContents) {
  const RegisterMap map = load_shipped_map({"sunspec_124", ""});
  RecordingMask mask(map, -1);
  const auto kept = [&](std::uint16_t address, std::vector<std::uint16_t> values) {
    BusExchange exchange = reading(address, std::move(values));
    mask.apply(exchange);
    return std::vector(exchange.values().begin(), exchange.values().end());
  };
  EXPECT_THAT(kept(40'000, {0x5375, 0x6E53}), ElementsAre(0x5375, 0x6E53));
  EXPECT_THAT(kept(40'002, {1, 66}), ElementsAre(1, 66));
  EXPECT_THAT(kept(40'004, {0x4672, 0x6F6E}), ElementsAre(0, 0));  // manufacturer, in model 1
  EXPECT_THAT(kept(40'070, {124, 24}), ElementsAre(124, 24));
  const RegisterPoint& soc = map.points[find_point(map, "soc")];
  EXPECT_THAT(kept(static_cast<std::uint16_t>(40'070 + soc.address), {4'350}), ElementsAre(4'350));
}

TEST_F(Recording, IsCompleteUnderItsNameAndAPartFileUntilThen) {
  const std::string path = folder_.file("device.jsonl");
  ExchangeRecorder recorder;
  ASSERT_TRUE(recorder.start(path.c_str(), head_, map_, clock_, error_)) << error_.c_str();
  const ExchangeListener listener = recorder.listener();
  BusExchange refused = reading(10, {0});
  refused.outcome = BusOutcome::kException;
  refused.exception = 2;
  BusExchange silence = reading(10, {0});
  silence.outcome = BusOutcome::kTimeout;
  for (const BusExchange& exchange : {reading(10, {0xFFFE}), refused, silence}) {
    listener.on_exchange(listener.owner, exchange);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  ASSERT_TRUE(recorder.finish(error_)) << error_.c_str();
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
  const std::vector<std::string> lines = lines_of(path);
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_THAT(lines[0], HasSubstr("{\"bess_recording\":1,\"version\":\"0\",\"map\":\"talkative\""));
  EXPECT_THAT(lines[1], HasSubstr("\"unit\":1,\"function\":3,\"address\":10,\"count\":1,"
                                  "\"latency_us\":700,\"values\":[65534]}"));
  EXPECT_THAT(lines[2], HasSubstr("\"latency_us\":700,\"exception\":2}"));
  EXPECT_THAT(lines[3], HasSubstr("\"latency_us\":700,\"error\":\"timeout\"}"));
  EXPECT_THAT(lines[4], HasSubstr("\"exchanges\":3,\"dropped\":0}"));
  BusRecordingReader reader;
  std::string error;
  ASSERT_TRUE(reader.open(path, CutRecording::kRefused, error)) << error;
  BusExchange exchange;
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(reader.next(exchange, error), BusRecordingReader::Next::kExchange) << error;
  }
  EXPECT_EQ(reader.next(exchange, error), BusRecordingReader::Next::kEnd) << error;
}

TEST_F(Recording, EndsAtItsBoundAndIsStillWhole) {
  const std::string path = folder_.file("device.jsonl");
  constexpr std::int64_t kBytesMax = 4'000;
  ExchangeRecorder recorder;
  ASSERT_TRUE(recorder.start(path.c_str(), head_, map_, clock_, error_, kBytesMax));
  const ExchangeListener listener = recorder.listener();
  for (int i = 0; i < 100; ++i) listener.on_exchange(listener.owner, reading(10, {1}));
  ASSERT_TRUE(recorder.finish(error_)) << error_.c_str();
  EXPECT_LE(std::filesystem::file_size(path), kBytesMax);
  EXPECT_GT(recorder.exchanges(), 10);
  EXPECT_LT(recorder.exchanges(), 100);
  EXPECT_THAT(lines_of(path).back(),
              HasSubstr("\"exchanges\":" + std::to_string(recorder.exchanges()) + ","));
}

TEST_F(Recording, AFolderThatIsNotThereIsOneLine) {
  ExchangeRecorder recorder;
  const std::string path = folder_.file("none/device.jsonl");
  EXPECT_FALSE(recorder.start(path.c_str(), head_, map_, clock_, error_));
  EXPECT_THAT(std::string(error_.view()), Names(path + ".part"));
}

TEST_F(Recording, ANameThatIsTakenLeavesThePartAndSaysSo) {
  const std::string path = folder_.file("taken");
  std::filesystem::create_directories(path + "/inside");
  ExchangeRecorder recorder;
  ASSERT_TRUE(recorder.start(path.c_str(), head_, map_, clock_, error_));
  EXPECT_FALSE(recorder.finish(error_));
  EXPECT_THAT(std::string(error_.view()), Names(path));
  EXPECT_TRUE(std::filesystem::exists(path + ".part"));
}

}  // namespace
}  // namespace bess
