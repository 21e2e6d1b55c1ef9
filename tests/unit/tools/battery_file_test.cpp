// [battery] of a configuration, as the simulator reads it.
#include <gmock/gmock.h>

#include "shared/battery_keys.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "tools/simulators/sim/commands.h"

namespace bess {
namespace {

TEST(BatteryFile, EveryKeyIsTakenAndWhatIsNotThereStays) {
  const TemporaryFolder folder;
  std::string text = "[train]\nsteps = 7\n[battery]\nwear_eur_per_mwh = 25\ninitial_soc = 0.5\n";
  BatteryParameters wanted;
  for (const BatteryKey& key : kBatteryKeys) {
    double& field = key.of(wanted);
    const std::string_view name = key.name;
    const bool is_end = name == "soc_max" || name == "cold_to_hour";  // above its start
    field = is_end ? 0.9 : key.low + (key.high - key.low) / 64;
    text += std::string(key.name) + " = " + std::to_string(field) + "\n";
  }
  BatteryParameters battery;
  read_battery_file(folder.write("all.toml", text), battery);
  for (const BatteryKey& key : kBatteryKeys) {
    EXPECT_NEAR(key.of(battery), key.of(wanted), 1e-6) << key.name;
  }
  BatteryParameters house{.power_w_max = 4'000};
  read_battery_file(folder.write("one.toml", "[battery]\nstandby_w = 35\n"), house);
  EXPECT_EQ(house.power_w_max, 4'000);
  EXPECT_EQ(house.standby_w, 35);
}

TEST(BatteryFile, MistakesAreOneLineThatNamesThePlace) {
  const TemporaryFolder folder;
  const struct {
    const char* text;
    const char* complaint;
  } table[] = {{"steps = 7\n", "battery.toml [battery]"},
               {"[battery]\npower_kw = 4\n", "battery.toml:2"},
               {"[battery]\n\nstandby_w = -1\n", "battery.toml:3"},
               {"[battery]\ndelay_s = \"two\"\n", "battery.toml:2"},
               {"[battery]\nsoc_min = 0.9\nsoc_max = 0.5\n", "battery.toml soc_min soc_max"},
               {"[battery]\ncold_power_share = 0.6\n", "cold_from_hour cold_to_hour"},
               {"[battery\n", "battery.toml:1"}};
  for (const auto& row : table) {
    BatteryParameters battery;
    const std::string said =
        user_error_of([&] { read_battery_file(folder.write("battery.toml", row.text), battery); });
    EXPECT_THAT(said, Names(row.complaint)) << row.text;
    EXPECT_EQ(said.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace bess
