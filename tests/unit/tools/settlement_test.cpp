// Earnings of a run, by hand: four minutes of a battery of 3 kW, once charged and once discharged.
#include "tools/simulators/settle/settlement.h"

#include <gtest/gtest.h>

#include "shared/host/command_line.h"
#include "tests/support/temporary_folder.h"
#include "tools/simulators/sim/commands.h"

namespace bess {
namespace {

// 50 Wh a minute; prices of 100 while it charges and of -40 while it discharges.
constexpr const char* kPrices =
    "minute_utc,indicative_eur_mwh,settled_eur_mwh\n"
    "2023-01-01T12:00:00Z,,100\n2023-01-01T12:01:00Z,,100\n"
    "2023-01-01T12:02:00Z,,-40\n2023-01-01T12:03:00Z,,-40\n";
constexpr const char* kRecord =
    "minute_utc,energy_wh,soc\n"
    "2023-01-01T12:00:00Z,50,0.51\n2023-01-01T12:01:00Z,50,0.52\n"
    "2023-01-01T12:02:00Z,-50,0.51\n2023-01-01T12:03:00Z,-50,0.50\n";
constexpr const char* kEdgeLog =
    "utc,mode,soc_e4,ordered_power_w,written,decision_us,write_us,total_us\n"
    "2023-01-01T12:00:00Z,running,5000,3000,1,5,500,510\n"
    "2023-01-01T12:02:00Z,running,5200,-3000,1,5,500,510\n";

std::string settle_command(const TemporaryFolder& folder, const std::string& options) {
  CommandLine command_line("bess-sim", "", "");
  ProgramCommand root = command_line.root();
  add_settle_command(root);
  testing::internal::CaptureStdout();
  std::string failed;
  try {
    command_line.parse("settle --json --record " + folder.write("record.csv", kRecord) +
                       " --edge-log " + folder.write("log.csv", kEdgeLog) + " --prices " +
                       folder.write("prices.csv", kPrices) + " " + options);
  } catch (const std::exception& error) {
    failed = error.what();
  }
  return testing::internal::GetCapturedStdout() + failed;
}

TEST(Settlement, TheCommandTakesTheCostsByTheNamesOfTheConfiguration) {
  const TemporaryFolder folder;
  // Of the battery's own record and of the edge's log.
  const auto profits_of = [&](const std::string& options) {
    const std::string line = settle_command(folder, options), key = "\"profit_eur\":";
    if (line.find(key) == std::string::npos) return "none: " + line;
    return line.substr(line.find(key) + key.size(), 9) + ' ' +
           line.substr(line.rfind(key) + key.size(), 9);
  };
  // 100 Wh taken at 100 EUR/MWh and 100 Wh given at -40: 1 EUR/MWh more either way is 0.0001 EUR.
  EXPECT_EQ(profits_of(""), "-0.014000 -0.014000");
  EXPECT_EQ(profits_of("--import-adder-eur-per-mwh 45"), "-0.018500 -0.018500");
  EXPECT_EQ(profits_of("--import-percent 5"), "-0.014500 -0.014500");
  EXPECT_EQ(profits_of("--export-fee-eur-per-mwh 2"), "-0.014200 -0.014200");
  EXPECT_EQ(profits_of("--export-percent 5"), "-0.014200 -0.014200") << "of 40, whatever its sign";
  EXPECT_EQ(profits_of("--wear-eur-per-mwh 10"), "-0.016000 -0.016000");
  for (const char* bad :
       {"--import-adder-eur-per-mwh -1", "--import-percent 101", "--export-fee-eur-per-mwh 1001",
        "--export-percent x", "--wear-eur-per-mwh -0.1"}) {
    EXPECT_EQ(profits_of(bad).substr(0, 4), "none") << bad;
  }
}

}  // namespace
}  // namespace bess
