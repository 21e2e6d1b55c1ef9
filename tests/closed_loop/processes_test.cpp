// The real programs together: bess-edge between bess-sim battery and bess-sim market, over Modbus
// TCP and HTTP on free ports, in scaled time. The battery's own record is held against the edge's
// log.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "shared/scaled_clock.h"
#include "shared/utc_text.h"
#include "tests/support/child_process.h"
#include "tests/support/pty_bridge.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

using ::testing::HasSubstr;

constexpr std::int32_t kScale = 900;
constexpr std::int64_t kStartS = 1'679'788'800;  // 2023-03-26T00:00:00Z, an hour before summer time

/// Two hours and a half of prices that make the battery charge, rest and discharge.
std::string minute_file_text() {
  std::ostringstream text;
  text << "minute_utc,indicative_eur_mwh,settled_eur_mwh\n";
  for (int minute = -60; minute < 150; ++minute) {
    const double price = 100 + 400 * std::sin(minute / 7.0);
    text << utc_text(kStartS + 60 * minute).view() << ',' << price << ',' << price << '\n';
  }
  return text.str();
}

using CsvRow = std::map<std::string, std::string>;

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields;
  std::stringstream rest(line);
  for (std::string field; std::getline(rest, field, ',');) fields.push_back(field);
  return fields;
}

std::vector<CsvRow> read_csv(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> names = split(line);
  std::vector<CsvRow> rows;
  while (std::getline(file, line)) {
    const std::vector<std::string> fields = split(line);
    CsvRow row;
    for (std::size_t i = 0; i < names.size() && i < fields.size(); ++i) row[names[i]] = fields[i];
    rows.push_back(row);
  }
  return rows;
}

/// Starts the two simulators; the edge is started by each test.
class Processes : public ::testing::Test {
 protected:
  std::vector<std::string> clock_options() const {
    return {"--utc-start",          "2023-03-26T00:00:00Z",  "--time-scale",
            std::to_string(kScale), "--anchor-monotonic-ns", std::to_string(anchor_ns_)};
  }
  std::unique_ptr<ChildProcess> start_simulator(std::vector<std::string> arguments, int& port) {
    arguments.insert(arguments.begin(), BESS_SIM_PROGRAM);
    for (const std::string& option : clock_options()) arguments.push_back(option);
    auto child = std::make_unique<ChildProcess>(arguments);
    const std::string line = child->read_line();  // "... listening on HOST:PORT, ..."
    const std::size_t colon = line.find(':', line.find("127.0.0.1"));
    port = colon == std::string::npos ? 0 : std::atoi(line.c_str() + colon + 1);
    EXPECT_GT(port, 0) << line;
    return child;
  }
  void start_simulators(const std::vector<std::string>& market_faults = {},
                        const std::vector<std::string>& battery_faults = {}) {
    std::vector<std::string> battery = {"battery", "--port", "0", "--record",
                                        folder_.file("battery.csv")};
    battery.insert(battery.end(), battery_faults.begin(), battery_faults.end());
    battery_ = start_simulator(battery, battery_port_);
    std::vector<std::string> market = {"market", "--port", "0", "--prices",
                                       folder_.write("minutes.csv", minute_file_text())};
    market.insert(market.end(), market_faults.begin(), market_faults.end());
    market_ = start_simulator(market, market_port_);
  }
  std::string write_config(const std::string& serial_device = "") const {
    std::ostringstream text;
    text << "control = true\n[battery]\nmap = \"" BESS_SOURCE_DIR "/edge/maps/alphaess.toml\"\n";
    if (serial_device.empty()) {
      text << "port = " << battery_port_ << "\n";
    } else {
      text << "transport = \"rtu\"\nbaud = 115200\ndevice = \"" << serial_device << "\"\n";
    }
    text
        << "response_timeout_ms = 100\nstart_timeout_s = 1\n"
        << "[price]\nurl = \"http://127.0.0.1:" << market_port_
        << "/api/explore/v2.1/catalog/datasets/ods161/records?order_by=datetime%20desc&limit=20\"\n"
        << "[log]\ncsv = \"edge.csv\"\n[simulation]\ntime_scale = " << kScale
        << "\nutc_start = \"2023-03-26T00:00:00Z\"\nanchor_monotonic_ns = " << anchor_ns_ << "\n";
    return folder_.write("edge.toml", text.str());
  }
  int stop(ChildProcess& child) {
    child.signal(SIGTERM);
    return child.wait();
  }

  TemporaryFolder folder_;
  std::int64_t anchor_ns_ = clock_ns(CLOCK_MONOTONIC) + kNanosecondsPerSecond / 2;
  int battery_port_ = 0;
  int market_port_ = 0;
  std::unique_ptr<ChildProcess> battery_;
  std::unique_ptr<ChildProcess> market_;
};

TEST_F(Processes, TheBatterysOwnRecordAgreesWithTheEdgesLog) {
  start_simulators();
  ChildProcess edge({BESS_EDGE_PROGRAM, "--config", write_config(), "--cycles", "45"});
  EXPECT_THAT(edge.read_all(), HasSubstr("stopped: battery released"));
  EXPECT_EQ(edge.wait(), 0);
  EXPECT_EQ(stop(*battery_), 0);
  EXPECT_EQ(stop(*market_), 0);

  double ordered_wh = 0;
  int moves = 0;
  const std::vector<CsvRow> log = read_csv(folder_.file("edge.csv"));
  ASSERT_EQ(log.size(), 46U);  // 45 cycles and the stop
  for (const CsvRow& row : log) {
    if (row.at("mode") == "stopping") continue;
    EXPECT_EQ(row.at("mode"), "running") << row.at("utc");
    EXPECT_EQ(row.at("written"), "1");
    const int power_w = std::stoi(row.at("ordered_power_w"));
    EXPECT_LE(std::abs(power_w), 4'000);
    ordered_wh += power_w / 30.0;
    if (power_w != 0) ++moves;
  }
  EXPECT_GT(moves, 10);
  double exchanged_wh = 0;
  for (const CsvRow& row : read_csv(folder_.file("battery.csv"))) {
    exchanged_wh += std::stod(row.at("energy_wh"));
    EXPECT_GE(std::stod(row.at("soc")), 0.1);
    EXPECT_LE(std::stod(row.at("soc")), 1.0);
  }
  // Each order begins about a second of simulated time after its tick; a busy machine needs more.
  EXPECT_NEAR(exchanged_wh, ordered_wh, 0.1 * 4'000 / 30.0 * moves);
}

TEST_F(Processes, SigtermOrdersZeroReleasesAndExitsWithZero) {
  start_simulators();
  ChildProcess edge({BESS_EDGE_PROGRAM, "--config", write_config()});
  EXPECT_EQ(edge.read_line(), "started: in control");
  for (int i = 0; i < 3; ++i) EXPECT_THAT(edge.read_line(), HasSubstr("mode="));
  edge.signal(SIGTERM);
  EXPECT_THAT(edge.read_all(), HasSubstr("mode=stopping"));
  EXPECT_EQ(edge.wait(), 0);
  EXPECT_EQ(stop(*battery_), 0);
  const std::vector<CsvRow> record = read_csv(folder_.file("battery.csv"));
  ASSERT_FALSE(record.empty());
  EXPECT_EQ(record.back().at("commanded_power_w"), "0");
}

TEST_F(Processes, AKilledEdgeIsEndedByTheBatterysDeadManTimer) {
  start_simulators();
  ChildProcess edge({BESS_EDGE_PROGRAM, "--config", write_config()});
  for (int i = 0; i < 4; ++i) edge.read_line();
  edge.signal(SIGKILL);
  EXPECT_EQ(edge.wait(), 128 + SIGKILL);
  sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + kNanosecondsPerSecond / 2);  // 450 s
  EXPECT_EQ(stop(*battery_), 0);
  EXPECT_EQ(read_csv(folder_.file("battery.csv")).back().at("commanded_power_w"), "0");
}

TEST_F(Processes, MarketFaultsDoNotStopTheLoop) {
  for (const char* fault : {"null", "http-500", "stale", "garbage"}) {
    anchor_ns_ = clock_ns(CLOCK_MONOTONIC) + kNanosecondsPerSecond / 2;
    start_simulators({"--fault", fault, "--fault-every", "3"});
    std::filesystem::remove(folder_.file("edge.csv"));
    ChildProcess edge({BESS_EDGE_PROGRAM, "--config", write_config(), "--cycles", "10"});
    edge.read_all();
    EXPECT_EQ(edge.wait(), 0) << fault;
    int running = 0;
    for (const CsvRow& row : read_csv(folder_.file("edge.csv"))) {
      if (row.at("mode") == "running") ++running;
    }
    EXPECT_GE(running, 9) << fault;
    stop(*battery_);
    stop(*market_);
  }
}

TEST_F(Processes, TheSameOverASerialLine) {
  start_simulators();
  const PtyBridge line;
  std::vector<std::string> arguments = {BESS_SIM_PROGRAM, "battery", "--serial",
                                        line.device(0),   "--baud",  "115200"};
  for (const std::string& option : clock_options()) arguments.push_back(option);
  ChildProcess battery(arguments);
  EXPECT_THAT(battery.read_line(), HasSubstr("listening on " + line.device(0)));
  ChildProcess edge(
      {BESS_EDGE_PROGRAM, "--config", write_config(line.device(1)), "--cycles", "15"});
  EXPECT_THAT(edge.read_all(), HasSubstr("stopped: battery released"));
  EXPECT_EQ(edge.wait(), 0);
  int written = 0;
  for (const CsvRow& row : read_csv(folder_.file("edge.csv"))) {
    if (row.at("written") == "1") ++written;
  }
  EXPECT_GE(written, 14);
  EXPECT_EQ(stop(battery), 0);
}

/// Whatever the bus does, what the log calls written is what the battery was commanded.
TEST_F(Processes, BusFaultsCostCyclesButNeverGiveAWrongOrder) {
  start_simulators({}, {"--fault", "exception", "drop", "reset", "wrong-unit", "wrong-transaction",
                        "wrong-protocol", "wrong-address", "wrong-value", "fewer-registers",
                        "garbage", "duplicate", "refuse", "ack-without-effect",
                        "--fault-probability", "0.15", "--fault-seed", "4"});
  ChildProcess edge({BESS_EDGE_PROGRAM, "--config", write_config(), "--cycles", "40"});
  edge.read_all();
  EXPECT_EQ(edge.wait(), 0);
  EXPECT_EQ(stop(*battery_), 0);
  std::map<std::int64_t, std::string> commanded;  // at the end of each minute
  const auto instant = [](const std::string& text) {
    std::int64_t utc_s = 0;
    EXPECT_TRUE(parse_utc_text(text, utc_s)) << text;
    return utc_s;
  };
  for (const CsvRow& row : read_csv(folder_.file("battery.csv"))) {
    commanded[instant(row.at("minute_utc"))] = row.at("commanded_power_w");
  }
  int written = 0;
  int troubled = 0;
  for (const CsvRow& row : read_csv(folder_.file("edge.csv"))) {
    if (row.at("battery_status") != "ok") ++troubled;
    if (row.at("mode") == "stopping" || row.at("written") != "1") continue;
    ++written;
    const std::int64_t last_minute_s = instant(row.at("utc")) + 60;  // of this order
    EXPECT_EQ(commanded[last_minute_s], row.at("ordered_power_w")) << row.at("utc");
  }
  EXPECT_GE(written, 20);
  EXPECT_GE(troubled, 1);
}

TEST_F(Processes, CheckReportsAndReadsButWritesNothing) {
  start_simulators();
  sleep_until_monotonic(anchor_ns_);
  ChildProcess edge({BESS_EDGE_PROGRAM, "--config", write_config(), "--check"});
  const std::string text = edge.read_all();
  EXPECT_EQ(edge.wait(), 0) << text;
  EXPECT_THAT(text, HasSubstr("charge     0x0880:[1 0 28000 0 32000 2 250 0 300 255 0]"));
  EXPECT_THAT(text, HasSubstr("SoC 50.0 %"));
  EXPECT_THAT(text, HasSubstr("dispatch off"));
  EXPECT_THAT(text, HasSubstr("EUR/MWh of minute"));
}

TEST_F(Processes, BadStartsEndWithOneClearLine) {
  battery_port_ = 1;
  market_port_ = 1;
  const std::string config = write_config();
  struct Start {
    std::vector<std::string> arguments;
    int exit_code;
    const char* message;
  };
  const Start starts[] = {
      {{BESS_EDGE_PROGRAM, "--config", config}, 1, "battery at 127.0.0.1:1 unit 85: no connection"},
      {{BESS_EDGE_PROGRAM, "--config", "/nonexistent"}, 1, "cannot open"},
      {{BESS_EDGE_PROGRAM, "--confg", config}, 2, "unknown option --confg"},
      {{BESS_EDGE_PROGRAM, "--config", config, "--cycles", "x"}, 2, "needs a whole number"},
      {{BESS_EDGE_PROGRAM}, 2, "--config FILE is required"},
      {{BESS_SIM_PROGRAM, "batery"}, 2, "unknown subcommand batery"},
      {{BESS_SIM_PROGRAM, "market", "--prices", "/nonexistent"}, 1, "cannot open"},
      {{BESS_SIM_PROGRAM, "battery", "--soc", "2"}, 2, "--soc"},
      {{BESS_SIM_PROGRAM, "battery", "--fault", "crc"}, 2, "--fault"},
      {{BESS_SIM_PROGRAM, "battery", "--fault", "bad-crc"}, 1, "bad-crc: only on a serial line"},
      {{BESS_SIM_PROGRAM, "battery", "--serial", "/nonexistent"}, 1, "cannot open this serial"},
  };
  for (const Start& start : starts) {
    ChildProcess child(start.arguments);
    const std::string text = child.read_all();
    EXPECT_EQ(child.wait(), start.exit_code) << text;
    EXPECT_THAT(text, HasSubstr(start.message));
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  }
}

TEST_F(Processes, TheWrongBatteryIsRefusedBeforeAnythingIsWritten) {
  battery_ = start_simulator(
      {"battery", "--port", "0", "--capacity-wh", "12000", "--record", folder_.file("battery.csv")},
      battery_port_);
  market_port_ = 1;
  ChildProcess edge({BESS_EDGE_PROGRAM, "--config", write_config()});
  EXPECT_THAT(edge.read_all(), HasSubstr("capacity reads 12000, not 6000 to 10000"));
  EXPECT_EQ(edge.wait(), 1);
}

/// An independent master sees the registers that the edge's commands stand for.
TEST_F(Processes, MbpollReadsWhatTheMapSays) {
  if (access("/usr/bin/mbpoll", X_OK) != 0) GTEST_SKIP() << "mbpoll is not installed";
  start_simulators();
  const std::string port = std::to_string(battery_port_);
  const auto mbpoll = [&](std::vector<std::string> rest) {
    std::vector<std::string> arguments = {
        "/usr/bin/mbpoll", "-m", "tcp", "-p", port, "-a", "85", "-0", "-t", "4"};
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    ChildProcess child(arguments);
    return child.read_all();
  };
  EXPECT_THAT(mbpoll({"-r", "258", "-c", "1", "-1", "127.0.0.1"}), HasSubstr("[258]: \t500"));
  EXPECT_THAT(mbpoll({"-r", "2176", "127.0.0.1", "1", "0", "28000", "0", "32000", "2", "250", "0",
                      "300", "255", "0"}),
              HasSubstr("Written 11 references"));
  EXPECT_THAT(mbpoll({"-r", "294", "-c", "1", "-1", "127.0.0.1"}), HasSubstr("(-4000)"));
  EXPECT_THAT(mbpoll({"-r", "60000", "-c", "1", "-1", "127.0.0.1"}),
              HasSubstr("Illegal data address"));
}

}  // namespace
}  // namespace bess
