// Real bess-edge against independent meters (pymodbus), one for each shipped map: --check must read
// what the meter shows, in both directions.
#include <gmock/gmock.h>

#include "tests/support/peer_programs.h"
#include "tests/support/simulated_site.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

class MeterPeers : public PeerTest, public ::testing::WithParamInterface<const char*> {
 protected:
  MeterPeers() : PeerTest("pymodbus") {}
};

TEST_P(MeterPeers, CheckReadsWhatTheMeterShows) {
  SimulatedSite site(60);
  site.start_both();
  for (const int watts : {2'340, -1'230}) {
    ChildProcess meter({kPython, BESS_SOURCE_DIR "/tests/system/peers/meter_peer.py", "--map",
                        GetParam(), "--watts", std::to_string(watts)});
    const std::string ready = meter.read_line();
    ASSERT_THAT(ready, ::testing::HasSubstr("127.0.0.1:"));
    const std::string config = site.write_config(
        {.guard_keys = "[meter]\nmap = \"" BESS_SOURCE_DIR "/edge/device/meters/" +
                       std::string(GetParam()) +
                       ".toml\"\nhost = \"127.0.0.1\"\nport = " + port_in(ready) + "\n"});
    ChildProcess check({edge_program(), "--config", config, "--check", "--dry-run"});
    EXPECT_THAT(check.read_all(), Names("meter grid " + std::to_string(watts) + " W"));
    check.wait();
    meter.signal(SIGKILL);
    meter.wait();
  }
}

INSTANTIATE_TEST_SUITE_P(Maps, MeterPeers,
                         ::testing::Values("sunspec", "fronius_smart_meter", "victron_gx",
                                           "eastron_sdm630", "p1_dongle_pro"),
                         [](const auto& meter) { return std::string(meter.param); });

}  // namespace
}  // namespace bess
