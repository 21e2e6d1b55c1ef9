// Recording of a device that bess-edge drives, and its replay: the real programs decide the same
// against the recording. The map fits the recording, and a map with a mistake does not.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "shared/host/pty_bridge.h"
#include "tests/support/edge_answer.h"
#include "tests/support/shipped_maps.h"
#include "tests/support/signal_handler.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::int32_t kScale = 120;
constexpr int kCycles = 8;

/// Inputs and orders of a control cycle, without its duration.
std::string decisions(const std::string& csv_path) {
  std::string text;
  for (const CsvRow& row : read_csv(csv_path)) {
    for (const char* name :
         {"utc", "mode", "soc_e4", "battery_power_w", "price_centi_eur_per_mwh", "student_action",
          "ordered_power_w", "reason", "battery_status", "written"}) {
      text.append(name).append("=").append(row.at(name)).append(" ");
    }
    text += "\n";
  }
  return text;
}

/// A mistake in a map, and the point that must be named.
struct Mistake {
  const char* point;
  const char* keys;
  const char* finding;
};

struct Recorded {
  MapVariant map;
  std::vector<Mistake> mistakes;
  std::vector<std::string> faults = {};  ///< options of the simulator
  friend void PrintTo(const Recorded& r, std::ostream* out) { PrintTo(r.map, out); }
};

class RecordReplay : public ::testing::TestWithParam<Recorded> {
 protected:
  [[nodiscard]] std::string battery_keys() const {
    const MapVariant& m = GetParam().map;
    return "map = \"" + shipped_map(m.map) + "\"\n" +
           (*m.variant == '\0' ? "" : std::string("variant = \"") + m.variant + "\"\n") +
           "response_timeout_ms = 500\nstart_timeout_s = 2\n";
  }
  [[nodiscard]] std::vector<std::string> battery_options() const {
    const MapVariant& m = GetParam().map;
    std::vector<std::string> options = {"--map", shipped_map(m.map)};
    if (*m.variant != '\0') options.insert(options.end(), {"--variant", m.variant});
    return joined(options, GetParam().faults);
  }
  /// Both simulators at the same ports, with a restarted clock.
  void start_again(const std::vector<std::string>& options) {
    if (site_.battery) SimulatedSite::stop(*site_.battery);
    if (site_.market) SimulatedSite::stop(*site_.market);
    const int battery_port = site_.battery ? site_.battery_port : 0;
    const int market_port = site_.market ? site_.market_port : 0;
    site_.start_clock();
    site_.start_battery(options, battery_port);
    site_.start_market({}, SimulatedSite::minute_prices(150), market_port);
  }
  /// Drives the device; returns its decisions. The sign check is reused.
  std::string drive(const std::string& state, const std::vector<std::string>& options = {}) {
    const std::string folder = site_.folder.file(state);
    std::filesystem::create_directories(folder);
    std::filesystem::copy_file(site_.folder.file("state/commissioned.toml"),
                               folder + "/commissioned.toml",
                               std::filesystem::copy_options::overwrite_existing);
    const std::string config = site_.write_config({.battery_keys = battery_keys(), .state = state});
    std::filesystem::remove(site_.folder.file("edge.csv"));
    const ProgramOutput driven =
        edge(joined({"--config", config, "--cycles", std::to_string(kCycles)}, options));
    EXPECT_EQ(driven.exit_code, 0) << driven.text;
    return decisions(site_.folder.file("edge.csv"));
  }
  ProgramOutput check(const std::string& map) const {
    std::vector<std::string> words = {"map", "check", "--against", recording_, "--map", map};
    const char* const variant = GetParam().map.variant;
    if (*variant != '\0') words.insert(words.end(), {"--variant", variant});
    return edge(words);
  }
  /// The shipped map with a few keys of a point changed.
  [[nodiscard]] std::string map_with(const Mistake& mistake) const {
    std::filesystem::copy_file(shipped_map(GetParam().map.map), site_.folder.file("right.toml"),
                               std::filesystem::copy_options::overwrite_existing);
    return site_.folder.write("wrong.toml",
                              std::string("include = \"right.toml\"\n[[point]]\nname = \"") +
                                  mistake.point + "\"\n" + mistake.keys + "\n");
  }

  SimulatedSite site_{kScale};
  std::string recording_ = site_.folder.file("device.jsonl");
};

TEST_P(RecordReplay, DecidesTheSameAndTheMapFits) {
  start_again(battery_options());
  static_cast<void>(site_.commission({.battery_keys = battery_keys()}));
  start_again(battery_options());
  const std::string recorded = drive("recorded", {"--record", recording_});
  EXPECT_THAT(recorded, ::testing::ContainsRegex("mode=running .* ordered_power_w=-?[1-9]"));

  start_again({"--replay", recording_});
  EXPECT_EQ(drive("replayed"), recorded);
  SimulatedSite::stop(*site_.battery);
  std::istringstream said(text_of_file(site_.log_of("battery")));
  std::string first, rest;
  std::getline(said, first);
  EXPECT_TRUE(std::getline(said, rest) && said.peek() == EOF)
      << "it knew an answer to everything: " << said.str();

  const ProgramOutput fits = check(shipped_map(GetParam().map.map));
  EXPECT_EQ(fits.exit_code, 0) << fits.text;
  for (const Mistake& mistake : GetParam().mistakes) {
    SCOPED_TRACE(std::string(mistake.point) + ": " + mistake.keys);
    const ProgramOutput wrong = check(map_with(mistake));
    EXPECT_EQ(wrong.exit_code, 1);
    EXPECT_THAT(wrong.text,
                ::testing::ContainsRegex(std::string(mistake.point) + " .*" + mistake.finding));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Maps, RecordReplay,
    ::testing::Values(
        Recorded{{"alphaess", "block"},
                 {{"soc", "scale = 1", "10"},
                  {"soc", "scale = 1000", "scale 10"},
                  {"battery_power", "sign = 1", "sign"},
                  {"battery_power", "type = \"u16\"", "type = \"s16\""},
                  {"capacity", "address = 0x0200", ""}}},
        Recorded{{"sunspec_704", ""},
                 {{"battery_power", "sign = 1", "sign"}, {"soc", "scale = 10000", "scale"}}},
        Recorded{{"victron_ess3", "three_phase"}, {{"battery_power", "sign = -1", "sign"}}},
        Recorded{{"huawei_luna2000", ""},
                 {{"capacity", "word_order = \"low_first\"", "word_order = \"high_first\""},
                  {"battery_power", "sign = -1", "sign"}}},
        Recorded{{"sungrow_sh", "external_ems"}, {{"soc", "scale = 1000", "scale"}}},
        // A device that is busy now and then is equally busy in the replay.
        Recorded{{"simulator", ""}, {}, {"--fault", "exception", "--fault-every", "7"}},
        Recorded{{"sma", "bms_mode"},
                 {{"soc", "word_order = \"low_first\"", "word_order = \"high_first\""}}}),
    [](const auto& info) {
      const MapVariant& m = info.param.map;
      return std::string(m.map) + (*m.variant == '\0' ? "" : std::string("_") + m.variant);
    });

/// `bess-edge record`, and a file that is incomplete.
class RecordCommand : public SiteTest {
 protected:
  RecordCommand() : SiteTest(kScale) {}
  void SetUp() override {
    site_.start_battery();
    config_ = site_.write_config();
  }
  ProgramOutput record(std::vector<std::string> options) const {
    options.insert(options.begin(), "record");
    return ask(std::move(options));
  }
  ProgramOutput check(const std::string& path) const {
    return ask({"map", "check", "--against", path});
  }

  std::string path_ = site_.folder.file("device.jsonl");
};

TEST_F(RecordCommand, ReadsWhatTheMapNamesAndWritesNothing) {
  const ProgramOutput recorded = record({"--for", "10m", "--every", "10s", "--out", path_});
  EXPECT_EQ(recorded.exit_code, 0) << recorded.text;
  EXPECT_THAT(recorded.text, Names("0 127.0.0.1:" + std::to_string(site_.battery_port)));
  const std::string text = text_of_file(path_);
  EXPECT_THAT(text,
              ::testing::AllOf(HasSubstr("\"map\":\"alphaess\""), HasSubstr("{\"end\":"),
                               Not(HasSubstr("\"function\":16")), Not(HasSubstr("\"function\":6")),
                               Not(HasSubstr("127.0.0.1"))));
  const ProgramOutput fits = check(path_);
  EXPECT_EQ(fits.exit_code, 0) << fits.text;
  EXPECT_THAT(fits.text, Names("sign scale")) << "which cannot be judged";
}

TEST_F(RecordCommand, AnInterruptedRecordingIsWhole) {
  ChildProcess child(
      {edge_program(), "record", "--config", config_, "--for", "7d", "--out", path_});
  ASSERT_TRUE(catches(child.pid(), SIGINT));
  for (int ms = 0; ms < 60'000; ++ms) {  // until each point and more is there
    if (count_of(text_of_file(path_ + ".part"), "\n") >= 100) break;
    usleep(1'000);
  }
  child.signal(SIGINT);
  EXPECT_THAT(child.read_all(), HasSubstr(path_));
  EXPECT_EQ(child.wait(), 0);
  EXPECT_EQ(check(path_).exit_code, 0);
}

TEST_F(RecordCommand, ASerialLineIsRecordedAndReplayedAsWell) {
  const PtyBridge line;
  const auto serve = [&](const std::vector<std::string>& options) {
    const std::string start(utc_text(SimulatedSite::kStartS).view());
    const std::string anchor = std::to_string(site_.anchor_ns());
    auto simulator = std::make_unique<ChildProcess>(
        joined({sim_program(), "battery", "--serial", line.device(0), "--utc-start", start,
                "--time-scale", std::to_string(kScale), "--anchor-monotonic-ns", anchor},
               options));
    EXPECT_THAT(simulator->read_line(), HasSubstr(line.device(0)));
    return simulator;
  };
  config_ = site_.write_config({.battery_keys = SimulatedSite::alphaess_keys(500) +
                                                "transport = \"rtu\"\ndevice = \"" +
                                                line.device(1) + "\"\n"});
  auto simulator = serve({"--soc", "0.43"});
  ASSERT_EQ(record({"--for", "2m", "--out", path_}).exit_code, 0);
  SimulatedSite::stop(*simulator);
  EXPECT_THAT(text_of_file(path_), HasSubstr("\"transport\":\"rtu\""));
  simulator = serve({"--replay", path_});
  const ProgramOutput seen = ask({"--check"});
  EXPECT_THAT(seen.text, Names("85 43.0 0 W 8000 Wh"));
  EXPECT_EQ(SimulatedSite::stop(*simulator), 0);
}

TEST_F(RecordCommand, ACutOrDamagedRecordingIsOneLineOfEitherProgram) {
  ASSERT_EQ(record({"--for", "1m", "--out", path_}).exit_code, 0);
  const std::string whole = text_of_file(path_);
  const std::string cut = site_.folder.write("cut.jsonl", whole.substr(0, whole.size() / 2));
  std::string changed = whole;
  changed[changed.find("{\"utc\"") + 1] = '?';
  const std::string damaged = site_.folder.write("damaged.jsonl", changed);
  const auto replay = [](const std::string& path) -> std::vector<std::string> {
    return {sim_program(), "battery", "--port", "0", "--replay", path};
  };
  for (const auto& [path, what] :
       {std::pair(cut, "cut.jsonl"), std::pair(damaged, "damaged.jsonl:2")}) {
    for (const ProgramOutput& outcome : {check(path), answer_of(replay(path))}) {
      EXPECT_EQ(outcome.exit_code, 1);
      EXPECT_THAT(outcome.text, Names(what));
      EXPECT_EQ(std::count(outcome.text.begin(), outcome.text.end(), '\n'), 1) << outcome.text;
    }
  }
  ChildProcess accepted(joined(replay(cut), {"--accept-cut"}));
  EXPECT_THAT(accepted.read_line(), HasSubstr("127.0.0.1:"));
}

/// The value of `key = number` in a command's answer.
double number_of(const std::string& key, const std::string& text) {
  const std::size_t at = text.find(key + " = ");
  return at == std::string::npos ? NAN : std::atof(text.c_str() + at + key.size() + 3);
}

TEST_F(RecordCommand, StepsOfACommissionShowDelayRampAndLag) {
  SimulatedSite site(12);  // a slow clock: a bus delay of 10 ms blurs 0.1 s
  site.start_battery({"--map", shipped_map("simulator"), "--battery",
                      site.folder.write("real.toml",
                                        "[battery]\npower_w = 4000\ncapacity_wh = 8000\n"
                                        "soc_min = 0\ndelay_s = 2\nramp_w_per_s = 600\n"
                                        "time_constant_s = 3\nstandby_w = 35\n")});
  const std::string config = site.write_config(
      {.battery_keys = "map = \"" + shipped_map("simulator") + "\"\nstart_timeout_s = 2\n"});
  const ProgramOutput driven = edge({"commission", "--config", config, "--record", path_, "--yes"});
  ASSERT_EQ(driven.exit_code, 0) << driven.text;
  const ProgramOutput reported =
      edge({"map", "check", "--against", path_, "--steps", "--config", config});
  ASSERT_EQ(reported.exit_code, 0) << reported.text;
  EXPECT_NEAR(number_of("delay_s", reported.text), 2, 1) << reported.text;
  EXPECT_NEAR(number_of("ramp_w_per_s", reported.text), 600, 180);
  EXPECT_NEAR(number_of("time_constant_s", reported.text), 3, 1);
  EXPECT_THAT(reported.text, Names("[response] settle_s"));
}

}  // namespace
}  // namespace bess
