// Start and end of the controller in virtual time: its calls of the world and its observers, their
// order, and its reaction to refusals.
#include "edge/app/program/controller.h"

#include <gmock/gmock.h>

#include <optional>

#include "shared/scaled_clock.h"
#include "tests/support/tokens.h"
#include "tools/hil_runner/base/work_folder.h"
#include "tools/hil_runner/scenario/edge_settings.h"
#include "tools/hil_runner/scenario/publication.h"
#include "tools/hil_runner/virtual/virtual_bus.h"
#include "tools/hil_runner/virtual/virtual_world.h"

namespace bess {
namespace {

using ::testing::ElementsAre;

/// Virtual time that records its calls.
class WatchedWorld : public VirtualWorld {
 public:
  using VirtualWorld::VirtualWorld;

  bool open() {
    calls.emplace_back("open");
    return may_open;
  }
  RestoredState restore_state() {
    calls.emplace_back("recall");
    return VirtualWorld::restore_state();
  }
  void keep(const CycleRecord& record) {
    calls.emplace_back("keep");
    VirtualWorld::keep(record);
  }
  const LatestHold& listen() {
    calls.emplace_back("listen");
    return VirtualWorld::listen();
  }
  void complain(JournalLevel, const std::string& line) { complaints.push_back(line); }
  void begins() { calls.emplace_back("begins"); }
  void is_ready() { calls.emplace_back("ready"); }
  void cycle_done(const CycleRecord&) { calls.emplace_back("cycle done"); }
  void stops() { calls.emplace_back("stops"); }
  void has_stopped(const CycleRecord& last, bool, bool) {
    calls.emplace_back("stopped");
    final_mode = last.mode;
  }

  bool may_open = true;
  std::vector<std::string> calls;
  std::vector<std::string> complaints;
  Mode final_mode = Mode::kStart;
};

/// A quiet hour around a controller, with or without a battery.
struct QuietHour {
  explicit QuietHour(const char* settings = "", bool has_device = true,
                     const MarketFaultSchedule& of_market = {})
      : scenario(read_scenario(BESS_SOURCE_DIR "/tests/scenarios/quiet_hour.toml")),
        prices(scenario_prices(scenario)),
        time(scenario),
        battery(scenario.battery.physics, scenario.battery.soc_frac, time.utc_ns()),
        market(prices, scenario.prices.latency_s),
        faults(of_market) {
    scenario.edge_battery = settings;
    const WorkFolder folder;
    config =
        load_edge_settings(scenario, folder.file("edge.toml"), edge_settings(scenario, prices, {}));
    if (has_device) {
      bus.emplace(VirtualBusSettings{.port = config.battery.link.port}, config.battery.map, battery,
                  time);
    }
    pthread_sigmask(SIG_SETMASK, nullptr, &mask);
    world.emplace(config, VirtualPrices(config.price.feed, market, faults, scenario, time),
                  VirtualWorld::VirtualEnvironment{.time = time,
                                                   .physics = battery,
                                                   .derating = nullptr,
                                                   .state = state,
                                                   .site_operator = site_operator});
    controller.emplace(config, *world);
  }
  QuietHour(const QuietHour&) = delete;
  QuietHour& operator=(const QuietHour&) = delete;
  ~QuietHour() { pthread_sigmask(SIG_SETMASK, &mask, nullptr); }

  Scenario scenario;
  MinuteSeries prices;
  VirtualTime time;
  SimulatedBattery battery;
  MarketView market;
  MarketFaultPlan faults;
  EdgeConfig config;
  std::optional<VirtualBus> bus;
  EdgeState state;
  VirtualOperator site_operator;
  sigset_t mask{};
  std::optional<WatchedWorld> world;
  std::optional<Controller<WatchedWorld>> controller;
};

TEST(Controller, ReachesBeginsRunsAndEnds) {
  QuietHour hour;
  EXPECT_TRUE(hour.controller->reach());
  EXPECT_TRUE(hour.world->calls.empty());
  EXPECT_TRUE(hour.controller->begin());
  EXPECT_THAT(hour.world->calls, ElementsAre("open", "begins", "recall", "listen", "ready"));
  hour.world->calls.clear();
  EXPECT_TRUE(hour.controller->run(2));
  EXPECT_THAT(hour.world->calls,
              ElementsAre("keep", "cycle done", "keep", "cycle done", "stops", "keep", "stopped"));
  EXPECT_EQ(hour.world->final_mode, Mode::kStopping);
  EXPECT_TRUE(hour.world->complaints.empty());
  ASSERT_EQ(hour.state.records().size(), 3U);
  // The last order kept its whole step; then the battery was released.
  const DispatchEvent& last = hour.battery.dispatch_events().back();
  EXPECT_EQ(last.kind, DispatchEvent::Kind::kStop);
  EXPECT_GE(last.utc_ns / kNanosecondsPerSecond, hour.state.records()[1].utc_s + kSecondsPerStep);
}

TEST(Controller, MakesNoCallsWhereItMayNotRun) {
  QuietHour hour;
  hour.world->may_open = false;
  EXPECT_TRUE(hour.controller->reach());
  const std::int64_t before_ns = hour.time.monotonic_ns();
  EXPECT_FALSE(hour.controller->begin());
  EXPECT_THAT(hour.world->calls, ElementsAre("open"));
  EXPECT_EQ(hour.time.monotonic_ns(), before_ns) << "no price was asked for";
}

TEST(Controller, SaysWhereItLookedForABatteryThatIsNotThere) {
  QuietHour hour("start_timeout_s = 3", false);
  const std::int64_t before_ns = hour.time.monotonic_ns();
  EXPECT_FALSE(hour.controller->reach());
  EXPECT_GE(hour.time.monotonic_ns(), before_ns + 3 * kNanosecondsPerSecond);
  EXPECT_LE(hour.time.monotonic_ns(), before_ns + 4 * kNanosecondsPerSecond);
  ASSERT_EQ(hour.world->complaints.size(), 1U);
  EXPECT_THAT(hour.world->complaints[0], Names("127.0.0.1:1 85"));
}

TEST(Controller, ReportsAMissingPriceAndStartsNevertheless) {
  QuietHour hour("", true, {.fault = MarketFault::kHttp500, .every = 1, .from_s = -1e6});
  EXPECT_TRUE(hour.controller->reach());
  EXPECT_TRUE(hour.controller->begin());
  ASSERT_EQ(hour.world->complaints.size(), 1U);
  EXPECT_THAT(hour.world->complaints[0], Names("price http://127.0.0.1:1"));
}

}  // namespace
}  // namespace bess
