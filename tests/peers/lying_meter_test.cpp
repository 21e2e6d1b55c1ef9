// The real bess-edge between bess-sim's battery and an independent meter (pymodbus) at the
// connection of a house that moves, who lies: frozen, inverted, of another ratio, late, on another
// phase, now and then. How long the limit is passed from the battery's first step under the lie on,
// by the meter's own record of the truth, and how soon it is found; with `judged = false` the same
// as it was before.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <future>

#include "tests/support/peer_programs.h"
#include "tests/support/simulated_site.h"

namespace bess {
namespace {

constexpr std::int32_t kScale = 120;  // a cycle takes a second
constexpr double kImportW = 4'500;
constexpr int kLieFromS = 840;
constexpr int kCycles = 24;

struct Lie {
  const char* name;
  const char* lie;
  int each_s = 0, for_s = 0;
  bool is_found = true;
  friend void PrintTo(const Lie& of, std::ostream* out) { *out << of.name; }
};

struct Damage {
  double over_s = 0;
  double over_w_max = 0;
  int steps = 0;
  int cycles_to_find = -1;
};

class LyingMeter : public ::testing::TestWithParam<Lie> {
 protected:
  void SetUp() override {
    const std::string missing = missing_peer("pymodbus");
    if (!missing.empty()) GTEST_SKIP() << missing;
  }

  /// Charging or discharging, another every six minutes, with rests.
  static std::string restless_prices() {
    std::ostringstream text;
    text << "minute_utc,indicative_eur_mwh,settled_eur_mwh\n";
    constexpr int kPrices[] = {-600, 1'600, -600, 100, 1'600};
    for (int minute = -60; minute < 200; ++minute) {
      const int price = kPrices[(minute + 60) / 4 % 5];
      text << utc_text(SimulatedSite::kStartS + 60 * minute).view() << ',' << price << ',' << price
           << '\n';
    }
    return text.str();
  }

  static Damage damage_of(const std::string& truth_path, const std::vector<CsvRow>& log) {
    Damage damage;
    std::ifstream truth(truth_path);
    double second = 0, house_w = 0, battery_w = 0, before_s = 0, before_w = 0, step_s = -1;
    for (std::string line; std::getline(truth, line); before_s = second, before_w = battery_w) {
      if (std::sscanf(line.c_str(), "%lf,%lf,%lf", &second, &house_w, &battery_w) != 3) break;
      if (second < kLieFromS) continue;
      if (std::abs(battery_w - before_w) >= 500) {
        if (step_s < 0) step_s = second;
        ++damage.steps;
      }
      if (step_s < 0) continue;
      const double over_w = house_w + battery_w - std::max(kImportW, house_w);
      if (over_w > 50) damage.over_s += second - before_s;
      damage.over_w_max = std::max(damage.over_w_max, over_w);
    }
    for (const CsvRow& row : log) {
      std::int64_t utc_s = 0;
      if (!parse_utc(row.at("utc"), utc_s) || row.at("meter_mismatch") != "1") continue;
      damage.cycles_to_find =
          static_cast<int>((static_cast<double>(utc_s - SimulatedSite::kStartS) - step_s) / 120) +
          1;
      break;
    }
    return damage;
  }

  static Damage run(const Lie& lie, bool judged) {
    SimulatedSite site(kScale);
    site.start_battery({"--map", BESS_SOURCE_DIR "/edge/maps/simulator.toml", "--clients-max", "4",
                        "--soc", "0.5", "--capacity-wh", "40000"});
    site.start_market({}, restless_prices());
    const std::string truth = site.folder.file("truth.csv");
    ChildProcess meter({kPython,          BESS_SOURCE_DIR "/tests/peers/meter_peer.py",
                        "--map",          "eastron_sdm630",
                        "--battery-port", std::to_string(site.battery_port),
                        "--scale",        std::to_string(kScale),
                        "--anchor-ns",    std::to_string(site.anchor_ns()),
                        "--lie",          lie.lie,
                        "--lie-from-s",   std::to_string(kLieFromS),
                        "--lie-each-s",   std::to_string(lie.each_s),
                        "--lie-for-s",    std::to_string(lie.for_s),
                        "--truth",        truth});
    const std::string ready = meter.read_line();
    EXPECT_THAT(ready, ::testing::HasSubstr("listening on"));
    const std::string config = site.commission(
        {.battery_keys = "map = \"" BESS_SOURCE_DIR "/edge/maps/simulator.toml\"\n"
                         "response_timeout_ms = 300\ncapacity_wh = 40000\n",
         .guard_keys = "[meter]\nmap = \"" BESS_SOURCE_DIR "/edge/meters/eastron_sdm630.toml\"\n"
                       "host = \"127.0.0.1\"\nresponse_timeout_ms = 300\nimport_w_max = 4500\n"
                       "port = " +
                       ready.substr(ready.find_last_of(':') + 1) +
                       "\njudged = " + (judged ? "true\n" : "false\n")});
    ChildProcess edge({edge_program(), "--config", config, "--cycles", std::to_string(kCycles)});
    edge.read_all();
    EXPECT_EQ(edge.wait(), 0);
    meter.signal(SIGKILL);
    meter.wait();
    return damage_of(truth, read_csv(site.folder.file("edge.csv")));
  }
};

TEST_P(LyingMeter, PassesALimitForAMinuteAtMost) {
  const Lie& lie = GetParam();
  auto believed = std::async(std::launch::async, run, lie, false);  // both wait nearly all the time
  const Damage now = run(lie, true);
  const Damage before = believed.get();
  std::printf(
      "%-16s believed: %4.0f s over, by %4.0f W | judged: %4.0f s over, by %4.0f W, found "
      "in cycle %d\n",
      lie.name, before.over_s, before.over_w_max, now.over_s, now.over_w_max, now.cycles_to_find);
  EXPECT_GT(now.steps, 3);
  EXPECT_EQ(now.cycles_to_find > 0, lie.is_found);
  EXPECT_LE(now.over_s, lie.is_found ? 60 : 120);
}

const auto kIndex = [](const auto& info) { return std::to_string(info.index); };
INSTANTIATE_TEST_SUITE_P(Everyday, LyingMeter, ::testing::Values(Lie{"inverted", "inverted"}),
                         kIndex);
INSTANTIATE_TEST_SUITE_P(More, LyingMeter,
                         ::testing::Values(Lie{"honest", "honest", 0, 0, false},
                                           Lie{"frozen", "frozen"}, Lie{"x 0.1", "x0.1"},
                                           Lie{"x 0.5", "x0.5"}, Lie{"other phase", "phase"},
                                           Lie{"60 s late", "late"},
                                           Lie{"frozen 5 of 10", "frozen", 600, 300}),
                         kIndex);

}  // namespace
}  // namespace bess
