// Site behind a meter with the real programs: bess-edge reads bess-sim's meter over Modbus, takes
// limits from `bess-edge limit`, and bess-sim's own record gives the real power.
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>

#include "tests/support/edge_answer.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::HasSubstr;

constexpr std::int32_t kScale = 120;

class SiteProcesses : public SiteTest {
 protected:
  SiteProcesses() : SiteTest(kScale) {}
  /// Prices at which the battery charges all the time, or in turns of six minutes; the house takes
  /// 1500 W.
  void start(const std::vector<std::string>& meter_options,
             const std::vector<int>& prices = {-600}) {
    std::vector<std::string> options = {"--soc", "0.3"};
    if (std::find(meter_options.begin(), meter_options.end(), "--house") == meter_options.end()) {
      options.insert(options.end(), {"--house", "1500"});
    }
    site_.start_battery(joined(options, meter_options));
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
  static std::vector<std::string> own_meter(const std::string& map,
                                            const std::vector<std::string>& options = {}) {
    return joined({"--meter-map", BESS_SOURCE_DIR "/edge/device/meters/" + map + ".toml"}, options);
  }
  [[nodiscard]] std::string meter_section(const std::string& keys,
                                          const std::string& map = "simulator") const {
    return "[meter]\nmap = \"" BESS_SOURCE_DIR "/edge/device/meters/" + map +
           ".toml\"\nresponse_timeout_ms = 30\nport = " + std::to_string(site_.meter_port) + "\n" +
           keys;
  }
  void commission(const std::string& sections) {
    config_ = site_.commission({.guard_keys = sections});
  }
  void configure(const std::string& sections) {
    config_ = site_.write_config({.guard_keys = sections});
  }
};

TEST_F(SiteProcesses, ALimitIsObeyedUntilItIsCleared) {
  start({});
  commission("[limits]\nfile = \"limit\"\n");
  const auto limit = [&](std::vector<std::string> options) {
    options.insert(options.begin(), "limit");
    const ProgramOutput said = ask(options);
    EXPECT_EQ(said.exit_code, 0) << said.text;
    return said.text;
  };
  EXPECT_THAT(limit({"--charge", "700", "--for", "2h"}),
              ::testing::AllOf(Names("700 W"), HasSubstr(" 2023-03-26 ")));
  ChildProcess edge = controller();
  EXPECT_THAT(await_line(edge, " written=1 "), Names("ordered_power_w=700 reason=outside_limit"));
  limit({"--clear"});
  EXPECT_THAT(await_line(edge, " ordered_power_w=4000 "), Names("reason=student"));
  static_cast<void>(site_.folder.write("limit", "0 0 tomorrow\n"));
  EXPECT_THAT(await_line(edge, " reason=outside_limit "), Names("ordered_power_w=0"));
  EXPECT_EQ(SimulatedSite::stop(edge), 0);
}

TEST_F(SiteProcesses, CheckSaysThatAHouseCannotGenerate) {
  start(own_meter("simulator", {"--meter-fault", "wrong-sign"}));
  usleep(600'000);  // faults begin with simulated time
  for (const auto& [keys, code] : {std::pair{"", 1}, std::pair{"pv_w_max = 2000\n", 0}}) {
    configure(meter_section(keys));
    const ProgramOutput said = ask({"--check", "--dry-run"});
    EXPECT_THAT(said.text, Names("grid house -1500"));
    EXPECT_EQ(has_code(said.text, "pv_w_max"), code == 1);
    EXPECT_EQ(said.exit_code, code) << said.text;
  }
}

TEST_F(SiteProcesses, CommissionOrdersNothingLargerUnderALimit) {
  start({});
  configure("[limits]\nfile = \"limit\"\n");
  EXPECT_EQ(ask({"limit", "--charge", "700", "--for", "2h"}).exit_code, 0);
  EXPECT_EQ(ask({"commission", "--yes"}).exit_code, 0);
  EXPECT_EQ(SimulatedSite::stop(*site_.battery), 0);
  for (const CsvRow& row : battery_record()) {
    EXPECT_LE(std::abs(std::stoi(row.at("commanded_power_w"))), 500);
  }
}

TEST_F(SiteProcesses, CommissionRefusesAMeterThatDoesNotFollow) {
  start(own_meter("simulator", {"--meter-fault", "wrong-sign"}));
  usleep(600'000);  // faults begin with simulated time
  configure(meter_section(""));
  const ProgramOutput liar = ask({"commission", "--yes"});
  EXPECT_THAT(liar.text, Names("meter -100 %"));
  EXPECT_EQ(liar.exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(site_.folder.file("state/commissioned.toml")));
}

/// Wrong meters of bess-sim, reported by journal, status and log.
TEST_F(SiteProcesses, AMeterThatDoesNotStepWithTheBatteryIsReportedAndLost) {
  start(own_meter("simulator", {"--meter-fault", "grid-scaled", "--meter-fault-from-s", "480"}),
        {-600, 1'600});
  commission(meter_section("import_w_max = 9000\n"));
  ChildProcess edge = controller();
  EXPECT_THAT(await_line(edge, " reason=meter_mismatch "), Names("ordered_power_w=0 mode=running"));
  await_line(edge, " cycle=");
  const ProgramOutput status = ask({"status"});
  EXPECT_THAT(status.text, Names("WARN meter meter_mismatch"));
  EXPECT_EQ(status.exit_code, 1);
  EXPECT_EQ(SimulatedSite::stop(edge), 0);
  const ProgramOutput again = ask({"--cycles", "1"});
  EXPECT_THAT(again.text, HasSubstr(" reason=meter_mismatch "));  // over a restart
  EXPECT_EQ(again.exit_code, 0);
}

}  // namespace
}  // namespace bess
