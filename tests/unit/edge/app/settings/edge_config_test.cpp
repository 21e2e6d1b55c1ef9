// Configuration of the operator: the documented example loads, and every mistake is one clear line.
#include "edge/app/settings/edge_config.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>

#include "edge/app/storage/instance_lock.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

/// A valid configuration; a test adds or replaces a piece of it.
std::string valid_text() {
  return "control = true\n"
         "[battery]\n"
         "map = \"" BESS_SOURCE_DIR
         "/edge/device/maps/alphaess.toml\"\n"
         "power_w = 4000\n"
         "[price]\n"
         "url = \"http://127.0.0.1:1/records\"\n"
         "[guard]\n"
         "soc_min = 0.2\n"
         "[simulation]\n"
         "time_scale = 900\n"
         "utc_start = \"2023-03-26T00:00:00Z\"\n"
         "anchor_monotonic_ns = 5\n";
}

class ConfigFile : public ::testing::Test {
 protected:
  bool load(const std::string& text) {
    config_ = std::make_unique<EdgeConfig>();
    error_.clear();
    return load_edge_config(folder_.write("edge.toml", text), *config_, error_);
  }
  void load_good(const std::string& text) { ASSERT_TRUE(load(text)) << error_; }
  /// The valid text with `more` before the first `place`.
  static std::string with(std::string_view place, const std::string& more) {
    std::string text = valid_text();
    return text.insert(text.find(place), more);
  }

  const TemporaryFolder folder_;
  std::unique_ptr<EdgeConfig> config_ = std::make_unique<EdgeConfig>();
  std::string error_;
};

TEST_F(ConfigFile, TheDocumentedExampleIsValidAndReadOnly) {
  ASSERT_TRUE(load_edge_config(BESS_SOURCE_DIR "/edge/bess-edge.toml", *config_, error_)) << error_;
  EXPECT_FALSE(config_->control.control);
  EXPECT_TRUE(config_->clock.is_real_time());
  EXPECT_EQ(config_->control.guard.thresholds, (PriceThresholds{-500, 1500}));
  EXPECT_EQ(config_->control.order_duration_s, 300);
  EXPECT_EQ(config_->battery.map.unit, 85);
}

TEST_F(ConfigFile, ReadsEveryUnit) {
  load_good(with("soc_min", "low_price_eur_per_mwh = -120.0\nhigh_price_eur_per_mwh = 640\n"));
  EXPECT_TRUE(config_->control.control);
  EXPECT_EQ(config_->control.guard.thresholds, (PriceThresholds{-120, 640}));
  EXPECT_EQ(config_->control.guard.soc_min_e4, 2'000);
  EXPECT_EQ(config_->clock.scale, 900);
  EXPECT_EQ(config_->clock.anchor_utc_s, 1'679'788'800);
  EXPECT_EQ(config_->clock.anchor_monotonic_ns, 5);
}

/// They bound the effect of a wrong price source, and real prices never come near
/// (shared/manual/notebook/2026-11-22_limits_on_honest_prices.md).
TEST_F(ConfigFile, CyclesAndReversalsAreBoundedByDefault) {
  load_good(valid_text());
  EXPECT_EQ(config_->control.cycles_per_day_max_e4, 60'000);
  EXPECT_EQ(config_->control.reversals_per_hour_max, 20);
  EXPECT_EQ(config_->control.guard.ramp_w_max, 0);
  load_good(with("soc_min", "cycles_per_day_max = 0\nreversals_per_hour_max = 0\n"));
  EXPECT_EQ(config_->control.cycles_per_day_max_e4, 0);
  EXPECT_EQ(config_->control.reversals_per_hour_max, 0);
}

TEST_F(ConfigFile, ABatteryThatIsFullSoonerMayCycleMore) {
  load_good(with("power_w", "capacity_wh = 4000\n"));
  EXPECT_EQ(config_->control.cycles_per_day_max_e4, 120'000);
}

TEST_F(ConfigFile, UnitGroupsOfTheMapAreTheOperatorsToSet) {
  std::string text = valid_text();
  text.replace(text.find("alphaess"), 8, "victron_ess3");
  text.insert(text.find("power_w"), "units = { vebus = 246 }\n");
  load_good(text);
  const RegisterPoint& set_point =
      config_->battery.map.points[find_point(config_->battery.map, "set_l1")];
  EXPECT_EQ(config_->battery.map.unit_of(set_point), 246);
  EXPECT_EQ(config_->battery.map.unit, 100);
  EXPECT_EQ(config_->battery.link.port, 502);
  text.replace(text.find("vebus"), 5, "vecan");
  EXPECT_FALSE(load(text));
  EXPECT_THAT(error_, Names("vecan battery vebus"));
}

TEST_F(ConfigFile, ReadsTheSerialLinesSettings) {
  load_good(with("power_w",
                 "transport = \"rtu\"\ndevice = \"/dev/ttyS1\"\nbaud = 19200\n"
                 "parity = \"even\"\nstop_bits = 2\n"));
  EXPECT_TRUE(config_->battery.link.rtu);
  EXPECT_EQ(config_->battery.link.device.view(), "/dev/ttyS1");
  EXPECT_EQ(config_->battery.link.baud, 19'200);
  EXPECT_EQ(config_->battery.link.parity, Parity::kEven);
  EXPECT_EQ(config_->battery.link.stop_bits, 2);
}

TEST_F(ConfigFile, StateLogAndMetricsPathsAreRelativeToTheFile) {
  load_good(valid_text());
  EXPECT_EQ(config_->state.folder, folder_.file("state"));
  EXPECT_EQ(config_->log.ring, folder_.file("state/decisions.ring"));
  EXPECT_EQ(config_->log.status, folder_.file("state/status.json"));
  EXPECT_EQ(config_->log.metrics, folder_.file("state/metrics.prom"));
  EXPECT_TRUE(config_->log.csv.empty());
  EXPECT_EQ(config_->log.ring_days, 35);

  const std::string text = valid_text() +
                           "[state]\nfolder = \"/var/lib/bess\"\n"
                           "[log]\ndays = 365\ncsv = \"edge.csv\"\n"
                           "[metrics]\nprometheus = \"/tmp/bess.prom\"\n";
  load_good(text);
  EXPECT_EQ(config_->log.ring, "/var/lib/bess/decisions.ring");
  EXPECT_EQ(config_->log.csv, folder_.file("edge.csv"));
  EXPECT_EQ(config_->log.metrics, "/tmp/bess.prom");
  EXPECT_EQ(config_->log.ring_days, 365);
}

/// A relative path on the command line must be prefixed only once.
TEST_F(ConfigFile, ARelativeConfigurationKeepsItsStateNextToIt) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::create_directory(folder_.file("etc"));
  folder_.write("etc/edge.toml", valid_text());
  std::filesystem::current_path(folder_.file(""));
  EXPECT_TRUE(load_edge_config("etc/edge.toml", *config_, error_)) << error_;
  std::filesystem::current_path(before);
  EXPECT_EQ(config_->log.ring, "etc/state/decisions.ring");
}

/// Every spelling of one battery's address must lead to one lock; another battery to another lock.
TEST_F(ConfigFile, TheBatterysLockIsNamedByItsPlace) {
  config_->battery.map.unit = 85;
  const std::string folder_of_locks(lock_folder());
  EXPECT_EQ(battery_lock_path(*config_), folder_of_locks + "/bess-127.0.0.1_502_unit_85.lock");
  config_->battery.link.unit = 1;
  EXPECT_EQ(battery_lock_path(*config_), folder_of_locks + "/bess-127.0.0.1_502_unit_1.lock");
  config_->battery.link.rtu = true;
  config_->battery.link.device = folder_.write("ttyUSB0", "").c_str();
  const FixedText<639> direct = battery_lock_path(*config_);
  std::filesystem::create_symlink(folder_.file("ttyUSB0"), folder_.file("by-id"));
  config_->battery.link.device = folder_.file("by-id").c_str();
  EXPECT_EQ(battery_lock_path(*config_), direct.view());
}

struct ConfigMistake {
  std::string before, after;
  int line;
  std::string codes;
};

TEST_F(ConfigFile, EveryMistakeIsOneClearLineWithItsPlace) {
  const ConfigMistake mistakes[] = {
      {"control = true", "controll = true", 1, "controll"},
      {"control = true", "control = 1", 1, "control true false"},
      {"power_w = 4000", "power = 4000", 4, "power"},
      {"power_w = 4000", "power_w = 4000.5", 4, "power_w"},
      {"power_w = 4000", "power_w = 40000", 4, "power_w alphaess"},
      {"power_w = 4000", "power_w = -1", 4, "power_w"},
      {"power_w = 4000", "port = 70000", 4, "port 1 65535"},
      {"power_w = 4000", "host = \"battery.local\"", 4, "host IPv4"},
      {"power_w = 4000", "transport = \"udp\"", 4, "transport \"tcp\" \"rtu\""},
      {"power_w = 4000", "baud = 14400", 4, "baud 9600"},
      {"power_w = 4000", "baud = 1201", 4, "baud 9600"},
      {"power_w = 4000", "parity = \"mark\"", 4, "parity \"none\" \"even\" \"odd\""},
      {"power_w = 4000", "stop_bits = 3", 4, "stop_bits 1 2"},
      {"power_w = 4000", "variant = \"blok\"", 0, "blok block"},
      {"http://", "ftp://", 6, "url http:// https://"},
      {"url =", "uri =", 5, "url"},
      {"[price]\nurl = \"http:", "[price]\nca_file = \"none.pem\"\nurl = \"https:", 6, "none.pem"},
      {"[price]\nurl = \"http:", "[price]\nheader_file = \"none\"\nurl = \"https:", 0, "none"},
      {"[price]", "[price]\nhistory_hours = 97", 6, "history_hours 0 96"},
      {"[price]", "[price]\nhistory_url = \"http://127.0.0.1:2/records\"", 6, "history_url url"},
      {"[price]", "[price]\nhistory_url = \"127.0.0.1:1/records\"", 6, "history_url url"},
      {"[price]", "[price]\nlevel_start_eur_per_mwh = 1501", 6, "level_start_eur_per_mwh 1500"},
      {"soc_min = 0.2", "soc_min = 20", 8, "soc_min 0 1"},
      {"soc_min = 0.2", "soc_min = \"0.2\"", 8, "soc_min"},
      {"soc_min = 0.2", "soc_min = 1.0", 8, "soc_min soc_max"},
      {"soc_min = 0.2", "low_price_eur_per_mwh = 2000", 8,
       "low_price_eur_per_mwh high_price_eur_per_mwh"},
      {"soc_min = 0.2", "frozen_price_s_max = -1", 8, "frozen_price_s_max 0 86400"},
      {"soc_min = 0.2", "frozen_price_s_max = 86401", 8, "frozen_price_s_max 0 86400"},
      {"soc_min = 0.2", "low_price_eur_per_mwh = -15001", 8, "low_price_eur_per_mwh -15000 15000"},
      {"soc_min = 0.2", "high_price_eur_per_mwh = 999.5", 8, "high_price_eur_per_mwh"},
      {"soc_min = 0.2", "reversals_per_hour_max = 31", 8, "reversals_per_hour_max 0 30"},
      {"soc_min = 0.2", "stand_in_s_max = 3601", 8, "stand_in_s_max 0 3600"},
      {"2023-03-26T00:00:00Z", "2023-03-26 00:00", 11, "utc_start UTC"},
      {"time_scale = 900", "time_scale = 0", 10, "time_scale"},
      {"[guard]", "[log]\ndays = 0\n[guard]", 8, "days 1 3660"},
      {"[guard]", "[state]\nfoldr = \"x\"\n[guard]", 8, "foldr"},
      {"[guard]", "[state]\nfolder = \"\"\n[guard]", 8, "folder"},
      {"power_w = 4000", "units = { vebus = 1 }", 4, "vebus"},
      {"maps/alphaess", "maps/alfaess", 3, "alfaess.toml"},
      {"[guard]", "[gard]", 7, "gard"},
      {"[guard]", "[guard", 7, "TOML"},
  };
  for (const ConfigMistake& mistake : mistakes) {
    std::string text = valid_text();
    const std::size_t at = text.find(mistake.before);
    ASSERT_NE(at, std::string::npos) << mistake.before;
    text.replace(at, mistake.before.size(), mistake.after);
    EXPECT_FALSE(load(text)) << mistake.after;
    EXPECT_THAT(error_, Names(mistake.codes)) << mistake.after;
    EXPECT_EQ(error_.find('\n'), std::string::npos) << error_;
    if (mistake.line > 0) {
      EXPECT_THAT(error_,
                  ::testing::StartsWith(folder_.file("edge.toml:") + std::to_string(mistake.line)));
    }
  }
}

TEST_F(ConfigFile, ReadsThePriceLevelOfAFirstStart) {
  load_good(valid_text());
  EXPECT_EQ(config_->price.history.hours, 72);
  EXPECT_TRUE(config_->price.history.url.empty());
  EXPECT_FALSE(config_->price.level_start_centi_eur_per_mwh.has_value());
  load_good(with("[guard]",
                 "history_hours = 0\nhistory_url = \"http://127.0.0.1:1/past\"\n"
                 "level_start_eur_per_mwh = -12.5\n"));
  EXPECT_EQ(config_->price.history.hours, 0);
  EXPECT_EQ(config_->price.history.url, "http://127.0.0.1:1/past");
  EXPECT_EQ(config_->price.level_start_centi_eur_per_mwh, -1'250);
}

TEST_F(ConfigFile, ReadsTheKeysOfAnotherPriceServer) {
  const std::string headers = folder_.write("headers", "X-Api-Key: k\n");
  ASSERT_EQ(chmod(headers.c_str(), 0600), 0);
  std::string text = valid_text();
  text.replace(text.find("http://"), 7, "https://");  // secrets require it
  text.replace(
      text.find("[price]"), 7,
      "[price]\nheader_file = \"headers\"\nca_file = \"headers\"\nrows_field = \"data.rows\"");
  load_good(text);
  EXPECT_EQ(config_->price.feed.http.headers, "X-Api-Key: k");
  EXPECT_EQ(config_->price.feed.http.ca_file, headers);  // relative to the configuration
  EXPECT_EQ(config_->price.feed.fields.rows, "data.rows");
}

TEST_F(ConfigFile, ReadsWhereDayAheadPricesComeFrom) {
  const std::string headers = folder_.write("headers", "X-Api-Key: k\n");
  ASSERT_EQ(chmod(headers.c_str(), 0600), 0);
  const auto load_outlook = [&](const std::string& keys) {
    return load(valid_text() + "\n[outlook]\n" + keys);
  };
  ASSERT_TRUE(
      load_outlook("url = \"https://a.example/{today}\"\nheader_file = \"headers\"\n"
                   "ca_file = \"headers\"\nrows_field = \"r\"\ntime_field = \"t\"\n"
                   "price_field = \"p\"\n"))
      << error_;
  EXPECT_EQ(config_->outlook.http.url, "https://a.example/{today}");
  EXPECT_EQ(config_->outlook.http.headers, "X-Api-Key: k");
  EXPECT_EQ(config_->outlook.http.ca_file, headers);
  EXPECT_EQ(config_->outlook.fields.rows, "r");
  EXPECT_EQ(config_->outlook.fields.time, "t");
  EXPECT_EQ(config_->outlook.fields.price, "p");
  EXPECT_EQ(day_ahead_offset_s(*config_), 0);  // in simulated time
  ASSERT_TRUE(load_outlook("file = \"answer.json\"\n")) << error_;
  EXPECT_EQ(config_->outlook.file, folder_.file("answer.json"));
  const std::pair<const char*, const char*> mistakes[] = {
      {"file = \"a\"\nurl = \"https://a.example\"\n", "[outlook] file url"},
      {"url = \"http://a.example\"\n", "[outlook] url allow_http"},
      {"url = \"http://a.example\"\nallow_http = true\nheader_file = \"headers\"\n", "header_file"},
      {"minutes = 1\n", "minutes"},
  };
  for (const auto& [keys, message] : mistakes) {
    EXPECT_FALSE(load_outlook(keys)) << keys;
    EXPECT_THAT(error_, Names(message));
  }
}

/// Configurations of earlier versions still start; obsolete keys are reported as without effect.
TEST_F(ConfigFile, KeysThatAreNoLongerSettingsAreTakenAndNamed) {
  std::string text = valid_text();
  text.insert(text.find("[guard]") + 7, "\nhold_s = 10\norder_deadline_s = 5");
  text.insert(text.find("[price]") + 7, "\ntimeout_ms = 70\nresolve_every_s = 30");
  text +=
      "\n[outlook]\nask_spread_s = 0\n[state]\nlock_folder = \"x\"\n"
      "[notify]\nmail_to = \"me@example.org\"\n";
  load_good(text);
  EXPECT_EQ(config_->control.hold_s, 300);
  EXPECT_EQ(config_->price.feed.http.timeout_ms, 5'000);
  std::vector<std::string> named;
  for (const RetiredKey& old : config_->retired) named.emplace_back(old.key);
  EXPECT_THAT(named, testing::UnorderedElementsAre("hold_s", "order_deadline_s", "timeout_ms",
                                                   "resolve_every_s", "ask_spread_s", "lock_folder",
                                                   "mail_to"));
  EXPECT_THAT(keys_without_effect(*config_), testing::Contains(Names("[outlook] ask_spread_s")));
  // It is not suggested for a misspelt key.
  text.replace(text.find("timeout_ms"), 10, "timeoutms ");
  EXPECT_FALSE(load(text));
  EXPECT_THAT(error_, testing::AllOf(Names("[price] timeoutms url"),
                                     testing::Not(testing::HasSubstr("timeout_ms"))));
}

/// Spread over a thousand real machines; a simulated one fetches immediately.
TEST_F(ConfigFile, RealMachinesAskForTomorrowsPricesAtDifferentSeconds) {
  std::string text = valid_text();
  text.erase(text.find("[simulation]"));
  std::set<std::int32_t> seconds;
  for (int i = 0; i < 100; ++i) {
    load_good(text + "\n[state]\nfolder = \"state" + std::to_string(i) + "\"\n");
    const std::int32_t offset_s = day_ahead_offset_s(*config_);
    EXPECT_EQ(offset_s, day_ahead_offset_s(*config_));
    EXPECT_GE(offset_s, 0);
    EXPECT_LT(offset_s, 120);
    seconds.insert(offset_s);
  }
  EXPECT_GT(seconds.size(), 50U);
}

}  // namespace
}  // namespace bess
