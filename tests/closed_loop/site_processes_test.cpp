// Behind the meter with the real programs: bess-edge reads bess-sim's meter over Modbus, takes
// limits from `bess-edge limit`, and bess-sim's own record says what flowed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>

#include "tests/support/simulated_site.h"

namespace bess {
namespace {

using ::testing::HasSubstr;

constexpr std::int32_t kScale = 120;

class SiteProcesses : public ::testing::Test {
 protected:
  /// Prices at which the battery charges all the time, or by turns of six minutes; the house takes
  /// 1500 W.
  void start(const std::vector<std::string>& meter_options,
             const std::vector<int>& prices = {-600}) {
    std::vector<std::string> options = {"--soc", "0.3"};
    if (std::find(meter_options.begin(), meter_options.end(), "--house") == meter_options.end()) {
      options.insert(options.end(), {"--house", "1500"});
    }
    options.insert(options.end(), meter_options.begin(), meter_options.end());
    site_.start_battery(options);
    site_.start_market({}, turns_of(prices));
  }
  static std::string turns_of(const std::vector<int>& prices) {
    std::ostringstream text;
    text << "minute_utc,indicative_eur_mwh,settled_eur_mwh\n";
    for (int minute = -60; minute < 150; ++minute) {
      const int price = prices[static_cast<std::size_t>(minute + 60) / 6 % prices.size()];
      text << utc_text(SimulatedSite::kStartS + 60 * minute).view() << ',' << price << ',' << price
           << '\n';
    }
    return text.str();
  }
  static std::vector<std::string> own_meter(const std::string& map = "simulator") {
    return {"--meter-map", BESS_SOURCE_DIR "/edge/meters/" + map + ".toml"};
  }
  [[nodiscard]] std::string meter_section(const std::string& keys,
                                          const std::string& map = "simulator") const {
    return "[meter]\nmap = \"" BESS_SOURCE_DIR "/edge/meters/" + map +
           ".toml\"\nresponse_timeout_ms = 30\nport = " + std::to_string(site_.meter_port) + "\n" +
           keys;
  }
  std::string commission(const std::string& sections) {
    return site_.commission({.guard_keys = sections});
  }
  /// Runs a controller to its end; its log.
  std::vector<CsvRow> run(const std::string& config, int cycles) {
    ChildProcess edge({edge_program(), "--config", config, "--cycles", std::to_string(cycles)});
    edge.read_all();
    EXPECT_EQ(edge.wait(), 0);
    return read_csv(site_.folder.file("edge.csv"));
  }

  SimulatedSite site_{kScale};
};

TEST_F(SiteProcesses, TheBatteryChargesWithWhatTheHouseLeaves) {
  start(own_meter("sunspec"));
  const std::string config = commission(meter_section("import_w_max = 3000\n", "sunspec"));
  const std::vector<CsvRow> log = run(config, 6);
  ASSERT_EQ(log.size(), 7U);
  for (std::size_t i = 1; i < 6; ++i) {
    EXPECT_EQ(log[i].at("reason"), "import_limit");
    EXPECT_NEAR(std::stoi(log[i].at("ordered_power_w")), 1'300, 5);
    EXPECT_NEAR(std::stoi(log[i].at("grid_power_w")), 2'800, 5);
    EXPECT_EQ(log[i].at("meter_status"), "ok");
  }
  EXPECT_EQ(SimulatedSite::stop(*site_.battery), 0);
  for (const CsvRow& row : read_csv(site_.folder.file("battery.csv"))) {
    EXPECT_NEAR(std::stod(row.at("house_wh")), 25, 1e-6);
    EXPECT_LE(std::stod(row.at("grid_wh")), 3'000 / 60.0);
  }
}

TEST_F(SiteProcesses, TheBatterysOwnGridPointDoesAsWell) {
  start({});
  const std::string config = commission("[meter]\nsource = \"battery\"\nimport_w_max = 3000\n");
  const std::vector<CsvRow> log = run(config, 4);
  ASSERT_EQ(log.size(), 5U);
  EXPECT_NEAR(std::stoi(log[3].at("ordered_power_w")), 1'300, 5);
  EXPECT_EQ(log[3].at("reason"), "import_limit");
}

TEST_F(SiteProcesses, ASilentMeterLeavesTheBatteryIdleAndHealthSaysSo) {
  std::vector<std::string> options = own_meter();
  options.insert(options.end(), {"--meter-fault", "silence", "--meter-fault-from-s", "360"});
  start(options);
  const std::string config = commission(meter_section("import_w_max = 3000\n"));
  ChildProcess edge({edge_program(), "--config", config});
  std::string line;
  do line = edge.read_line();
  while (!line.empty() && line.find(" reason=meter_lost ") == std::string::npos);
  EXPECT_THAT(line, HasSubstr(" ordered_power_w=0 "));
  EXPECT_THAT(line, HasSubstr(" meter=timeout"));
  EXPECT_THAT(line, HasSubstr(" mode=running "));
  ChildProcess status({edge_program(), "status", "--config", config});
  EXPECT_THAT(status.read_all(), HasSubstr("WARN: meter: "));
  EXPECT_EQ(status.wait(), 1);
  EXPECT_EQ(SimulatedSite::stop(edge), 0);
}

TEST_F(SiteProcesses, ALimitIsObeyedUntilItIsCleared) {
  start({});
  const std::string config = commission("[limits]\nfile = \"limit\"\n");
  const auto limit = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {edge_program(), "limit", "--config", config});
    ChildProcess command(options);
    const std::string said = command.read_all();
    EXPECT_EQ(command.wait(), 0) << said;
    return said;
  };
  EXPECT_THAT(limit({"--charge", "700", "--for", "2h"}),
              HasSubstr("charge 700 W, discharge any W, until 2023-03-26T"));
  ChildProcess edge({edge_program(), "--config", config});
  const auto line_with = [&](const std::string& text) {
    std::string line;
    do line = edge.read_line();
    while (!line.empty() && line.find(text) == std::string::npos);
    return line;
  };
  EXPECT_THAT(line_with(" written=1 "), HasSubstr(" ordered_power_w=700 reason=outside_limit "));
  limit({"--clear"});
  EXPECT_THAT(line_with(" ordered_power_w=4000 "), HasSubstr(" reason=student "));
  static_cast<void>(site_.folder.write("limit", "0 0 tomorrow\n"));
  EXPECT_THAT(line_with(" reason=outside_limit "), HasSubstr(" ordered_power_w=0 "));
  EXPECT_EQ(SimulatedSite::stop(edge), 0);
}

TEST_F(SiteProcesses, TheCommandLineOfALimitIsChecked) {
  start({});
  const std::string without = site_.write_config();
  const auto exit_code = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), edge_program());
    ChildProcess command(arguments);
    command.read_all();
    return command.wait();
  };
  EXPECT_EQ(exit_code({"limit", "--config", without, "--for", "15m"}), 1);  // no [limits]
  const std::string with =
      site_.write_config({.guard_keys = "[limits]\nfile = \"limit\"\n", .state = "with"});
  EXPECT_EQ(exit_code({"limit", "--config", with}), 2);
  EXPECT_EQ(exit_code({"limit", "--config", with, "--for", "15"}), 2);
  EXPECT_EQ(exit_code({"limit", "--config", with, "--charge", "-1", "--for", "15m"}), 2);
  EXPECT_EQ(exit_code({"limit", "--config", with, "--for", "15m", "--clear"}), 2);
  EXPECT_EQ(exit_code({"limit", "--config", with, "--clear"}), 0);
}

TEST_F(SiteProcesses, CheckSaysThatAHouseCannotGenerate) {
  std::vector<std::string> options = own_meter();
  options.insert(options.end(), {"--meter-fault", "wrong-sign"});
  start(options);
  usleep(600'000);  // faults begin with simulated time
  for (const auto& [keys, code] : {std::pair{"", 1}, std::pair{"pv_w_max = 2000\n", 0}}) {
    const std::string config = site_.write_config({.guard_keys = meter_section(keys)});
    ChildProcess check({edge_program(), "--config", config, "--check", "--dry-run"});
    const std::string said = check.read_all();
    EXPECT_THAT(said, HasSubstr("meter      grid -1500 W (import is positive), house -1500 W"));
    EXPECT_EQ(said.find("house -1500 W: a load below zero") != std::string::npos, code == 1);
    EXPECT_EQ(check.wait(), code) << said;
  }
}

TEST_F(SiteProcesses, CommissionMovesTheMeterToo) {
  start(own_meter());
  const std::string config = site_.write_config({.guard_keys = meter_section("")});
  ChildProcess honest({edge_program(), "commission", "--config", config, "--yes"});
  const std::string said = honest.read_all();
  EXPECT_THAT(said, HasSubstr("charge     ordered 500 W, measured 500 W"));
  EXPECT_THAT(said, HasSubstr("discharge  ordered -500 W, measured -500 W"));
  EXPECT_THAT(said, HasSubstr("meter      shows 100 % of the battery's steps; house 1500 W"));
  EXPECT_EQ(honest.wait(), 0);
}

/// As most inverters do: once it was refused as a ramp of 48 W/s, which takes 166 s for 8 kW.
TEST_F(SiteProcesses, CommissionAcceptsAFirstOrderLag) {
  start({"--time-constant-s", "5"});
  const std::string config = site_.write_config({.guard_keys = ""});
  ChildProcess edge({edge_program(), "commission", "--config", config, "--yes"});
  const std::string said = edge.read_all();
  EXPECT_EQ(edge.wait(), 0) << said;
  EXPECT_THAT(said, HasSubstr("and no ramp: a step of 8000 W takes 1"));
  EXPECT_TRUE(std::filesystem::exists(site_.folder.file("state/commissioned.toml")));
}

/// Larger than the sign needs is only ordered where nobody forbids it.
TEST_F(SiteProcesses, CommissionOrdersNothingLargerUnderALimit) {
  start({});
  const std::string config = site_.write_config({.guard_keys = "[limits]\nfile = \"limit\"\n"});
  const std::vector<std::string> limit = {edge_program(), "limit", "--config", config,
                                          "--charge",     "700",   "--for",    "2h"};
  EXPECT_EQ(ChildProcess(limit).wait(), 0);
  ChildProcess edge({edge_program(), "commission", "--config", config, "--yes"});
  const std::string said = edge.read_all();
  EXPECT_EQ(edge.wait(), 0) << said;
  EXPECT_THAT(said, HasSubstr("then up to 500 W for seconds"));
}

TEST_F(SiteProcesses, CommissionRefusesAMeterThatDoesNotFollow) {
  std::vector<std::string> options = own_meter();
  options.insert(options.end(), {"--meter-fault", "wrong-sign"});
  start(options);
  usleep(600'000);  // faults begin with simulated time
  const std::string config = site_.write_config({.guard_keys = meter_section("")});
  ChildProcess liar({edge_program(), "commission", "--config", config, "--yes"});
  const std::string said = liar.read_all();
  EXPECT_THAT(said, HasSubstr("the meter does not step with the battery"));
  EXPECT_THAT(said, HasSubstr("shows -100 % of the battery's steps"));
  EXPECT_EQ(liar.wait(), 1);
  EXPECT_FALSE(std::filesystem::exists(site_.folder.file("state/commissioned.toml")));
}

TEST_F(SiteProcesses, CommissionRefusesMorePowerThanOrdered) {
  start({"--fault", "excess-power", "--fault-every", "1"});
  const std::string config = site_.write_config({.guard_keys = ""});
  ChildProcess edge({edge_program(), "commission", "--config", config, "--yes"});
  const std::string said = edge.read_all();
  EXPECT_THAT(said, HasSubstr("more power flows than ordered"));
  EXPECT_EQ(edge.wait(), 1);
  EXPECT_FALSE(std::filesystem::exists(site_.folder.file("state/commissioned.toml")));
}

/// bess-sim's own liars, told by journal, status and log.
TEST_F(SiteProcesses, AMeterThatDoesNotStepWithTheBatteryIsToldAndLost) {
  std::vector<std::string> options = own_meter();
  options.insert(options.end(), {"--meter-fault", "grid-scaled", "--meter-fault-from-s", "480"});
  start(options, {-600, 1'600});
  const std::string config = commission(meter_section("import_w_max = 9000\n"));
  ChildProcess edge({edge_program(), "--config", config});
  std::string line;
  do line = edge.read_line();
  while (!line.empty() && line.find(" reason=meter_mismatch ") == std::string::npos);
  EXPECT_THAT(line, HasSubstr(" ordered_power_w=0 "));
  EXPECT_THAT(line, HasSubstr(" mode=running "));
  do line = edge.read_line();
  while (!line.empty() && line.find(" cycle=") == std::string::npos);
  ChildProcess status({edge_program(), "status", "--config", config});
  EXPECT_THAT(status.read_all(), HasSubstr("WARN: meter: it does not step with the battery"));
  EXPECT_EQ(status.wait(), 1);
  EXPECT_EQ(SimulatedSite::stop(edge), 0);
  ChildProcess again({edge_program(), "--config", config, "--cycles", "1"});
  EXPECT_THAT(again.read_all(), HasSubstr(" reason=meter_mismatch "));  // over a restart
  EXPECT_EQ(again.wait(), 0);
}

TEST_F(SiteProcesses, ALoadBelowZeroIsSaidOnce) {
  std::vector<std::string> options = own_meter();
  options.insert(options.end(), {"--meter-fault", "grid-offset", "--meter-fault-from-s", "360",
                                 "--meter-fault-to-s", "720", "--house", "400"});
  start(options);
  const std::string config = commission(meter_section(""));
  ChildProcess edge({edge_program(), "--config", config, "--cycles", "8"});
  const std::string said = edge.read_all();
  EXPECT_EQ(edge.wait(), 0);
  EXPECT_THAT(said, HasSubstr("leaves the house a load below zero"));
  EXPECT_THAT(said, HasSubstr("the house's load is plausible again"));
}

TEST_F(SiteProcesses, CheckShowsGridAndHouse) {
  start(own_meter());
  const std::string config = commission(meter_section(""));
  ChildProcess check({edge_program(), "--config", config, "--check"});
  EXPECT_THAT(check.read_all(),
              HasSubstr("meter      grid 1500 W (import is positive), house 1500 W"));
  EXPECT_EQ(check.wait(), 0);
}

}  // namespace
}  // namespace bess
