// House load of the simulator: its source, and that every mistake in a file names its line.
#include "tools/simulators/battery_sim/house_load.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"

namespace bess {
namespace {

constexpr std::int64_t kHouseStart = 1'679'788'800;  // 2023-03-26T00:00:00Z

TEST(HouseLoad, IsConstantByANumber) {
  const HouseLoad house = HouseLoad::from_option("350.5", 1);
  EXPECT_EQ(house.power_w(kHouseStart), 350.5);
  EXPECT_EQ(house.power_w(-5), 350.5);
  EXPECT_EQ(HouseLoad::from_option("-2000", 1).power_w(kHouseStart), -2'000);
}

TEST(HouseLoad, RepeatsAFileFromItsEndOn) {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "house.csv", "minute_utc,house_w\n2023-03-26T00:00:00Z,100\n2023-03-26T00:01:00Z,-200\n");
  const HouseLoad house = HouseLoad::from_option(path, 1);
  EXPECT_EQ(house.power_w(kHouseStart + 59), 100);
  EXPECT_EQ(house.power_w(kHouseStart + 60), -200);
  EXPECT_EQ(house.power_w(kHouseStart + 120), 100);
  EXPECT_EQ(house.power_w(kHouseStart - 60), -200);
}

TEST(HouseLoad, AMistakeNamesItsLine) {
  const std::pair<const char*, const char*> mistakes[] = {
      {"utc,w\n", "house.csv:1"},
      {"minute_utc,house_w\n", "house.csv"},
      {"minute_utc,house_w\n2023-03-26T00:00:00Z\n", "house.csv:2 1 2"},
      {"minute_utc,house_w\n2023-03-26T00:00:00Z,nan\n", "house.csv:2 house_w nan"},
      {"minute_utc,house_w\n2023-03-26T00:00:00Z,1\n2023-03-26T00:02:00Z,1\n", "house.csv:3"}};
  for (const auto& [text, message] : mistakes) {
    EXPECT_THAT(user_error_of([&, rows = text] { HouseLoad::from_csv(rows, "house.csv"); }),
                Names(message));
  }
}

TEST(HouseLoad, AYearIsAHouseholdsAndTheSameForASeed) {
  const HouseLoad house = HouseLoad::daily(7);
  const HouseLoad same = HouseLoad::daily(7);
  const HouseLoad other = HouseLoad::daily(8);
  double sum_kwh = 0, highest_w = 0;
  int differences = 0;
  for (int m = 0; m < 365 * 1'440; ++m) {
    const std::int64_t utc_s = kHouseStart + 60 * m;
    const double power_w = house.power_w(utc_s);
    EXPECT_EQ(power_w, same.power_w(utc_s));
    EXPECT_GE(power_w, 180);
    differences += power_w != other.power_w(utc_s) ? 1 : 0;
    sum_kwh += power_w / 60e3;
    highest_w = std::max(highest_w, power_w);
  }
  EXPECT_GT(sum_kwh, 2'500);
  EXPECT_LT(sum_kwh, 8'000);
  EXPECT_GT(highest_w, 5'000);
  EXPECT_GT(differences, 10'000);
}

}  // namespace
}  // namespace bess
