// Real bess-edge and bess-sim's battery with a second master (pymodbus), which writes stop, or
// another mode, 30 s after each tick, or every other tick: by the manufacturers' tables, by hand.
// The edge finds it, and releases the battery.
#include <gmock/gmock.h>

#include <climits>

#include "tests/support/peer_programs.h"
#include "tests/support/shipped_maps.h"
#include "tests/support/simulated_site.h"

namespace bess {
namespace {

constexpr std::int32_t kScale = 60;  // a control cycle takes 2 s

struct SecondMaster {
  MapVariant map;
  const char* writes;  ///< stop or mode
  int every = 1;       ///< in every Nth step

  friend void PrintTo(const SecondMaster& m, std::ostream* out) {
    *out << m.map.map << " " << m.map.variant << " " << m.writes << " every " << m.every;
  }
};

class SecondMasterPeer : public PeerTest, public ::testing::WithParamInterface<SecondMaster> {
 protected:
  SecondMasterPeer() : PeerTest("pymodbus") {}

  /// Commissioned, at a price that requests charging in every control cycle.
  std::string start_site() {
    const MapVariant& m = GetParam().map;
    const std::string variant = m.variant;
    std::vector<std::string> options = {"--map", shipped_map(m.map), "--clients-max", "4", "--soc",
                                        "0.3"};
    if (!variant.empty()) options.insert(options.end(), {"--variant", variant});
    site_.start_battery(options);
    site_.start_market({}, SimulatedSite::flat_prices(600, -600));
    std::string keys = "map = \"" + shipped_map(m.map) + "\"\nresponse_timeout_ms = 2000\n";
    if (!variant.empty()) keys += "variant = \"" + variant + "\"\n";
    if (load_shipped_map(m).watchdog.kind == Watchdog::Kind::kNone)
      keys += "allow_without_watchdog = true\n";
    return site_.commission({.battery_keys = keys});
  }

  /// The first control cycle line that contains one of the texts; empty if there is none within
  /// `lines_max`.
  static std::string line_with(ChildProcess& edge, const std::vector<std::string>& texts,
                               int lines_max) {
    for (int i = 0; i < lines_max;) {
      const std::string line = edge.read_line();
      if (line.empty()) return "";
      if (line.find(" cycle=") == std::string::npos) continue;
      ++i;
      for (const std::string& text : texts) {
        if (line.find(text) != std::string::npos) return line;
      }
    }
    return "";
  }

  /// From the first disturbed tick until the release of the battery.
  [[nodiscard]] int cycles_from(std::int64_t first_utc_s) const {
    int cycles = 0;
    for (const CsvRow& row : read_csv(site_.folder.file("edge.csv"))) {
      std::int64_t utc_s = 0;
      if (!parse_utc(row.at("utc"), utc_s) || utc_s < first_utc_s) continue;
      if (row.at("mode") != "running") break;
      ++cycles;
    }
    return cycles;
  }

  SimulatedSite site_{kScale};
};

TEST_P(SecondMasterPeer, IsFoundAndTheBatteryReleased) {
  const std::string config = start_site();
  ChildProcess edge({edge_program(), "--config", config});
  ASSERT_NE(line_with(edge, {" written=1"}, 4), "");
  ChildProcess other(
      master_peer(site_, GetParam().map,
                  {"--interfere", GetParam().writes, "--every", std::to_string(GetParam().every)}));
  const std::string first = other.read_line();
  ASSERT_TRUE(first.starts_with("tick ")) << first << other.read_all();
  const std::int64_t first_utc_s = std::atoll(first.c_str() + 5);
  const int most = 3 * GetParam().every;
  // Lines of earlier control cycles are still in the pipe.
  const std::string found =
      line_with(edge, {"reason=other_master ", "reason=no_answer "}, most + 3);
  // Nothing can be read back, and the edge writes again every 30 s: it outdoes the other master.
  const bool is_blind = std::string(GetParam().map.variant) == "setpoint";
  EXPECT_EQ(found.empty(), is_blind);
  other.signal(SIGKILL);
  other.wait();
  edge.signal(SIGTERM);
  edge.read_all();
  EXPECT_EQ(edge.wait(), 0);
  EXPECT_EQ(SimulatedSite::stop(*site_.battery), 0);
  EXPECT_LE(cycles_from(first_utc_s), is_blind ? INT_MAX : most);
}

std::string test_name(const ::testing::TestParamInfo<SecondMaster>& info) {
  const SecondMaster& m = info.param;
  return std::string(m.map.map) + "_" + m.map.variant + "_" + m.writes + "_" +
         std::to_string(m.every);
}

std::vector<SecondMaster> on_every_map() {
  std::vector<SecondMaster> all;
  for (const MapVariant& map : kShippedMapVariants) {
    for (const char* writes : {"stop", "mode"}) all.push_back({map, writes});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(AlphaEss, SecondMasterPeer,
                         ::testing::Values(SecondMaster{{"alphaess", "block"}, "stop"},
                                           SecondMaster{{"alphaess", "block"}, "mode", 2}),
                         test_name);
INSTANTIATE_TEST_SUITE_P(EveryMap, SecondMasterPeer, ::testing::ValuesIn(on_every_map()),
                         test_name);

}  // namespace
}  // namespace bess
