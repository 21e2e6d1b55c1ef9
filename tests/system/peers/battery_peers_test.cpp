// Independent masters (pymodbus, mbpoll) with bess-sim's battery, one for each shipped map: ordered
// power flows, readings agree, and the energy in the simulator's record is power times time,
// computed by hand.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>

#include "tests/support/peer_programs.h"
#include "tests/support/shipped_maps.h"
#include "tests/support/simulated_site.h"
#include "tests/support/utc_of.h"

namespace bess {
namespace {

constexpr double kTolerance = 0.001;

class BatteryPeers : public PeerTest {
 protected:
  BatteryPeers() : PeerTest("pymodbus", {kMbpoll}) {}
  static std::vector<std::string> options(const MapVariant& m, const char* soc) {
    std::vector<std::string> options = {"--map", shipped_map(m.map), "--clients-max", "4", "--soc",
                                        soc};
    if (*m.variant != '\0') options.insert(options.end(), {"--variant", m.variant});
    return options;
  }
};

class EveryMapsPeers : public BatteryPeers, public ::testing::WithParamInterface<MapVariant> {};

TEST_P(EveryMapsPeers, WhatTheyOrderFlowsAndIsCounted) {
  SimulatedSite site(60);
  site.start_battery(options(GetParam(), "0.43"));
  ChildProcess peer(master_peer(site, GetParam()));
  double soc_permille = 0;
  ASSERT_EQ(std::sscanf(peer.read_line().c_str(), "soc %lf", &soc_permille), 1) << peer.read_all();
  EXPECT_DOUBLE_EQ(soc_permille, 430);
  struct Order {
    double watts, from_s, to_s, pymodbus_w, mbpoll_w;
  };
  std::vector<Order> orders;
  for (int i = 0; i < 2; ++i) {
    Order o{};
    ASSERT_EQ(
        std::sscanf(peer.read_line().c_str(), "order %lf from %lf to %lf pymodbus %lf mbpoll %lf",
                    &o.watts, &o.from_s, &o.to_s, &o.pymodbus_w, &o.mbpoll_w),
        5)
        << peer.read_all();
    EXPECT_EQ(o.pymodbus_w, o.watts);
    EXPECT_EQ(o.mbpoll_w, o.watts);
    orders.push_back(o);
  }
  EXPECT_EQ(peer.wait(), 0);
  EXPECT_EQ(SimulatedSite::stop(*site.battery), 0);
  int minutes = 0;
  for (const CsvRow& row : read_csv(site.folder.file("battery.csv"))) {
    const auto minute_s = static_cast<double>(utc_of(row.at("minute_utc")));
    for (const Order& o : orders) {
      if (minute_s < o.from_s || minute_s + 60 > o.to_s) continue;
      ++minutes;
      EXPECT_NEAR(std::stod(row.at("energy_wh")), o.watts / 60,
                  kTolerance * std::abs(o.watts) / 60);
    }
  }
  EXPECT_GE(minutes, 2);
}

INSTANTIATE_TEST_SUITE_P(
    Maps, EveryMapsPeers, ::testing::ValuesIn(kShippedMapVariants), [](const auto& info) {
      return std::string(info.param.map) +
             (*info.param.variant == '\0' ? "" : std::string("_") + info.param.variant);
    });

}  // namespace
}  // namespace bess
