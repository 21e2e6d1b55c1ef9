// Real bess-edge against an independent battery (pymodbus), watched by an independent master
// (mbpoll): the dispatch block of AlphaESS, register by register, for charge, idle, discharge and
// release, over TCP and over a serial line (socat), written as one block and as five writes. The
// expected registers are computed by hand from the vendor's manual:
//   0x0880 start | 32000 + W, below it charging (2) | 32000 + var (2) | mode 2 = SoC control |
//   SoC limit, 0.4 % each: ceiling 100 % = 255 (none), floor 10 % = 25 | seconds (2) | 255 | PV 0
#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>

#include "edge/core/control/control_types.h"
#include "tests/support/peer_programs.h"
#include "tests/support/simulated_site.h"

namespace bess {
namespace {

using ::testing::ElementsAreArray;
using ::testing::HasSubstr;

constexpr std::int32_t kScale = 60;  // control cycle of 2 s: time to kill the edge between orders

struct Setup {
  bool rtu;
  const char* variant;
};

/// State of market and battery, and the expected registers 0x0880..0x088A.
struct Situation {
  const char* name;
  int price_eur_per_mwh;
  int soc_permille;
  std::vector<int> dispatch;
};

const Situation kCharge{"charge", -600, 435, {1, 0, 28'000, 0, 32'000, 2, 255, 0, 300, 255, 0}};
const Situation kDischarge{
    "discharge", 1'600, 435, {1, 0, 36'000, 0, 32'000, 2, 25, 0, 300, 255, 0}};
/// Very cheap, but full.
const Situation kIdle{"idle", -600, 1'000, {1, 0, 32'000, 0, 32'000, 2, 255, 0, 300, 255, 0}};

/// The writes of one order.
std::vector<std::string> writes_of(const std::vector<int>& d, const std::string& variant) {
  const auto line = [&](int first, int count) {
    std::string text = std::string("write ").append(std::to_string(0x0880 + first));
    for (int i = first; i < first + count; ++i) {
      text.append(" ").append(std::to_string(d[static_cast<std::size_t>(i)]));
    }
    return text;
  };
  if (variant == "block") return {line(0, 11)};
  return {line(0, 1), line(1, 2), line(7, 2), line(6, 1), line(5, 1)};
}

/// Starts alphaess_peer.py instead of the site's battery; returns the line with its address.
std::string start_peer(SimulatedSite& site, int soc_permille,
                       const std::vector<std::string>& options) {
  site.start_clock();
  site.battery = std::make_unique<ChildProcess>(
      joined({kPython, BESS_SOURCE_DIR "/tests/system/peers/alphaess_peer.py", "--soc",
              std::to_string(soc_permille)},
             options));
  std::string ready = site.battery->read_line();
  EXPECT_THAT(ready, HasSubstr("listening on"));
  return ready;
}

class Peers : public PeerTest, public ::testing::WithParamInterface<Setup> {
 protected:
  Peers() : PeerTest("pymodbus, serial_asyncio", {kMbpoll, kSocat}) {}
  void SetUp() override {
    PeerTest::SetUp();
    if (!IsSkipped() && GetParam().rtu) start_line();
  }

  void start_line() {
    const auto end = [&](const char* name) {
      return "pty,raw,echo=0,link=" + site_.folder.file(name);
    };
    line_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{kSocat, end("battery_end"), end("edge_end")});
    for (int i = 0; i < 500 && access(site_.folder.file("edge_end").c_str(), F_OK) != 0; ++i) {
      sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + kNanosecondsPerSecond / 100);
    }
  }
  void start_battery(int soc_permille) {
    if (GetParam().rtu) {
      start_peer(site_, soc_permille, {"--serial", site_.folder.file("battery_end")});
    } else {
      site_.battery_port = std::stoi(port_in(start_peer(site_, soc_permille, {})));
    }
  }
  std::string battery_keys() const {
    const std::string keys =
        SimulatedSite::alphaess_keys(2'000) + "variant = \"" + GetParam().variant + "\"\n";
    if (!GetParam().rtu) return keys;
    return keys + "transport = \"rtu\"\ndevice = \"" + site_.folder.file("edge_end") + "\"\n";
  }
  /// Runs the edge in a situation up to its first order; then ends it with this signal.
  void run_edge(const Situation& situation, int signal) {
    start_battery(situation.soc_permille);
    ASSERT_FALSE(HasFailure());
    site_.start_market({}, SimulatedSite::flat_prices(60, situation.price_eur_per_mwh));
    const std::string config = site_.commission({.battery_keys = battery_keys()});
    ChildProcess edge({edge_program(), "--config", config});
    std::string line;
    do line = edge.read_line();
    while (!line.empty() && line.find(" written=1") == std::string::npos);
    ASSERT_THAT(line, HasSubstr("mode=running"));
    edge.signal(signal);
    edge.read_all();
    ASSERT_EQ(edge.wait(), signal == SIGKILL ? 128 + SIGKILL : 0);
  }

  /// mbpoll's reading of the dispatch block: each value is printed with its address.
  std::vector<int> read_dispatch() {
    std::vector<std::string> arguments = {kMbpoll, "-a", "85", "-0", "-r", "2176", "-c",
                                          "11",    "-t", "4",  "-1", "-o", "5"};
    if (GetParam().rtu) {
      arguments.insert(arguments.end(),
                       {"-m", "rtu", "-b", "9600", "-P", "none", site_.folder.file("edge_end")});
    } else {
      arguments.insert(arguments.end(),
                       {"-m", "tcp", "-p", std::to_string(site_.battery_port), "127.0.0.1"});
    }
    ChildProcess mbpoll(arguments);
    const std::string text = mbpoll.read_all();
    std::vector<int> registers;
    for (int address = 2'176; address < 2'187; ++address) {
      const std::string key = std::string("[").append(std::to_string(address)).append("]:");
      const std::size_t at = text.find(key);
      EXPECT_NE(at, std::string::npos) << text;
      // A value above 32767 is followed by its signed reading in brackets.
      if (at != std::string::npos) registers.push_back(std::atoi(text.c_str() + at + key.size()));
    }
    return registers;
  }
  /// All writes to the battery since its sign check, which ends with a release, in their order.
  std::vector<std::string> take_writes() {
    site_.battery->signal(SIGTERM);
    std::vector<std::string> writes;
    std::istringstream text(site_.battery->read_all());
    for (std::string line; std::getline(text, line);) {
      if (line.rfind("write ", 0) == 0) writes.push_back(line);
    }
    site_.battery.reset();
    site_.market.reset();
    const auto release = std::ranges::find_if(
        writes, [](const std::string& write) { return write.starts_with("write 2176 0"); });
    if (release == writes.end()) return {};
    return {release + 1, writes.end()};
  }

  SimulatedSite site_{kScale};
  std::unique_ptr<ChildProcess> line_;
};

TEST_P(Peers, EachOrderIsInTheDispatchBlockRegisterByRegister) {
  for (const Situation& situation : {kCharge, kIdle, kDischarge}) {
    SCOPED_TRACE(situation.name);
    run_edge(situation, SIGKILL);  // the order stays in force
    ASSERT_FALSE(HasFatalFailure());
    EXPECT_THAT(read_dispatch(), ElementsAreArray(situation.dispatch));
    EXPECT_THAT(take_writes(), ElementsAreArray(writes_of(situation.dispatch, GetParam().variant)));
  }
}

TEST_P(Peers, AStoppedEdgeLeavesTheBlockReleased) {
  run_edge(kCharge, SIGTERM);
  ASSERT_FALSE(HasFatalFailure());
  const bool block = std::string(GetParam().variant) == "block";
  const std::vector<int> released =
      block ? std::vector{0, 0, 32'000, 0, 32'000, 0, 0, 0, 90, 255, 0}
            : std::vector{0, 0, 32'000, 0, 32'000, 2, 255, 0, 300, 255, 0};
  EXPECT_THAT(read_dispatch(), ElementsAreArray(released));
  std::vector<std::string> expected = writes_of(kCharge.dispatch, GetParam().variant);
  for (const std::string& write : writes_of(kIdle.dispatch, GetParam().variant)) {
    expected.push_back(write);  // 0 W first
  }
  if (block) {
    expected.push_back(writes_of(released, "block")[0]);
  } else {
    expected.push_back("write 2177 0 32000");
    expected.push_back("write 2176 0");
  }
  EXPECT_THAT(take_writes(), ElementsAreArray(expected));
}

std::string setup_name(const ::testing::TestParamInfo<Setup>& info) {
  return std::string(info.param.rtu ? "rtu_" : "tcp_") + info.param.variant;
}

INSTANTIATE_TEST_SUITE_P(Bus, Peers,
                         ::testing::Values(Setup{false, "block"}, Setup{true, "five_writes"}),
                         setup_name);
INSTANTIATE_TEST_SUITE_P(OtherBus, Peers,  // long, in CMakeLists.txt
                         ::testing::Values(Setup{false, "five_writes"}, Setup{true, "block"}),
                         setup_name);

}  // namespace
}  // namespace bess
