// [meter] and [limits]: their meaning, and that every mistake is one line with its correction.
#include "edge/app/settings/edge_config.h"

#include <gmock/gmock.h>

#include "edge/records/why/explanation.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

struct Loaded {
  TemporaryFolder folder;
  std::unique_ptr<EdgeConfig> config = std::make_unique<EdgeConfig>();
  std::string error;
  bool is_good;

  explicit Loaded(const std::string& sections, const std::string& battery_map = "alphaess",
                  const std::string& battery_keys = "")
      : is_good(load_edge_config(
            folder.write("edge.toml", "[battery]\nmap = \"" BESS_SOURCE_DIR "/edge/device/maps/" +
                                          battery_map + ".toml\"\n" + battery_keys +
                                          "[price]\nurl = \"http://127.0.0.1:1/\"\n" + sections),
            *config, error)) {}
};

std::string meter(const std::string& keys) {
  return "[meter]\nmap = \"" BESS_SOURCE_DIR "/edge/device/meters/sunspec.toml\"\n" + keys;
}

TEST(SiteConfig, WithoutItsSectionsThereIsNone) {
  const Loaded loaded("");
  ASSERT_TRUE(loaded.is_good) << loaded.error;
  EXPECT_EQ(loaded.config->site.settings.meter, MeterSource::kNone);
  EXPECT_FALSE(loaded.config->site.settings.has_outside_limits);
}

TEST(SiteConfig, AMeterHasALinkLikeTheBatterys) {
  const Loaded loaded(
      meter("variant = \"single_phase\"\nhost = \"192.168.1.9\"\nport = 1502\n"
            "unit = 7\nimport_w_max = 9200\nexport_w_max = 0\npeak_w_max = 2500\n"
            "margin_w = 100\non_loss = \"ignore\"\n"));
  ASSERT_TRUE(loaded.is_good) << loaded.error;
  const SiteConfig& site = loaded.config->site;
  EXPECT_EQ(site.settings.meter, MeterSource::kMap);
  EXPECT_FALSE(site.settings.idle_without_meter);
  EXPECT_EQ(site.link.host, "192.168.1.9");
  EXPECT_EQ(site.link.port, 1502);
  EXPECT_EQ(site.link.unit, 7);
  EXPECT_EQ(site.map.models[0], 201);
  EXPECT_EQ(site.settings.connection.import_w_max, 9'200);
  EXPECT_EQ(site.settings.connection.export_w_max, 0);
  EXPECT_EQ(site.settings.connection.peak_w_max, 2'500);
}

TEST(SiteConfig, TheBatterysGridPointIsReadWithItsMeasurements) {
  const Loaded loaded("[meter]\nsource = \"battery\"\nimport_w_max = 9200\n");
  ASSERT_TRUE(loaded.is_good) << loaded.error;
  EXPECT_EQ(loaded.config->site.settings.meter, MeterSource::kBattery);
  const RegisterMap& map = loaded.config->battery.map;
  const auto point = static_cast<std::int8_t>(find_point(map, "grid_power"));
  EXPECT_TRUE(std::find(map.measure.begin(), map.measure.end(), point) != map.measure.end());
}

TEST(SiteConfig, TheLimitsFileIsNextToTheConfiguration) {
  const Loaded loaded("[limits]\nfile = \"limit\"\non_timeout = \"idle\"\n");
  ASSERT_TRUE(loaded.is_good) << loaded.error;
  EXPECT_EQ(loaded.config->site.limit_file, loaded.folder.file("limit"));
  EXPECT_TRUE(loaded.config->site.settings.idle_after_timeout);
}

TEST(SiteConfig, EveryMistakeNamesItsCorrection) {
  const std::pair<std::string, const char*> mistakes[] = {
      {"[meter]\nimport_w_max = 1000\n", "[meter] map"},
      {"[meter]\nmap = \"none.toml\"\n", "none.toml share/bess/meters"},
      {"[meter]\nmap = \"" BESS_SOURCE_DIR "/edge/device/maps/alphaess.toml\"\n",
       "[meter] map \"meter\""},
      {meter("import_w_max = 200\n"), "import_w_max margin_w 200"},
      {meter("peak_w_max = 100\n"), "peak_w_max margin_w"},
      {meter("peak_shave = true\n"), "peak_shave peak_w_max"},
      {meter("host = \"meter.local\"\n"), "host IPv4"},
      {meter("on_loss = \"charge\"\n"), "on_loss \"idle\" \"ignore\""},
      {"[meter]\nsource = \"battery\"\nhost = \"127.0.0.1\"\n", "host"},
      {"[limits]\n", "[limits] file"},
      {"[limits]\nfile = \"x\"\non_timeout = \"charge\"\n",
       "on_timeout \"release_limits\" \"idle\""}};
  for (const auto& [sections, message] : mistakes) {
    const Loaded loaded(sections);
    EXPECT_FALSE(loaded.is_good) << sections;
    EXPECT_THAT(loaded.error, ::testing::AllOf(Names(message), ::testing::HasSubstr("edge.toml:")));
  }
  const Loaded no_grid("[meter]\nsource = \"battery\"\n", "huawei_luna2000");
  EXPECT_THAT(no_grid.error, Names("huawei_luna2000 grid"));
  const std::string line = "transport = \"rtu\"\ndevice = \"/dev/ttyUSB0\"\n";
  const Loaded same(meter(line), "alphaess", line);
  EXPECT_THAT(same.error, Names("[meter] device"));
}

TEST(SiteConfig, AMeterIsHeldAgainstThisBatterysSteps) {
  const Loaded loaded(meter(""), "alphaess", "power_w = 3000\n");
  ASSERT_TRUE(loaded.is_good) << loaded.error;
  const SiteSettings& site = loaded.config->site.settings;
  EXPECT_TRUE(site.meter_check.judges);
  EXPECT_EQ(site.meter_check.power_w, 3'000);
  EXPECT_EQ(site.meter_check.settle_s, loaded.config->battery.map.response.settle_s);
  const Loaded reported(meter("judged = false\npv_w_max = 6000\n"));
  ASSERT_TRUE(reported.is_good) << reported.error;
  EXPECT_FALSE(reported.config->site.settings.meter_check.judges);
  EXPECT_EQ(reported.config->site.settings.pv_w_max, 6'000);
}

TEST(SiteConfig, AMetersMapDrivesNoBattery) {
  const Loaded loaded("", "../meters/sunspec");
  EXPECT_FALSE(loaded.is_good);
  EXPECT_THAT(loaded.error, Names("[meter]"));
}

TEST(DurationText, IsAWholeNumberWithItsUnit) {
  std::int64_t seconds = 0;
  for (const auto& [text, is_s] : {std::pair{"90s", 90}, std::pair{"15m", 900},
                                   std::pair{"168h", 604'800}, std::pair{"1d12h", 129'600}}) {
    EXPECT_TRUE(parse_duration(text, seconds)) << text;
    EXPECT_EQ(seconds, is_s) << text;
  }
  for (const char* const text : {"", "h", "15", "0m", "-1h", "1.5h", "169h", "7d1s", "1h30", "1w",
                                 "1h ", "99999999999999999999s"}) {
    EXPECT_FALSE(parse_duration(text, seconds)) << text;
  }
}

}  // namespace
}  // namespace bess
