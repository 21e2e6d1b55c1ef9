// Runs in virtual time: they are bit-identical when repeated, the energy equals a hand calculation,
// and the process state is unchanged.
#include "tools/hil_runner/virtual/virtual_time.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <cmath>

#include "edge/records/log/record_codec.h"
#include "shared/scaled_clock.h"
#include "tools/hil_runner/run/run_scenario.h"

namespace bess {
namespace {

Scenario shipped_scenario(const char* name) {
  return read_scenario(std::string(BESS_SOURCE_DIR "/tests/scenarios/") + name + ".toml");
}

TEST(VirtualTime, ARunRepeatsBitIdentically) {
  const Scenario scenario = shipped_scenario("bus_torn_frames");
  const Outcome first = run_scenario(scenario, true, {});
  const Outcome second = run_scenario(scenario, true, {});
  EXPECT_EQ(first.signature, second.signature);
  ASSERT_EQ(first.evidence.log.size(), second.evidence.log.size());
  for (std::size_t i = 0; i < first.evidence.log.size(); ++i) {
    RecordBytes one{}, other{};
    encode_record(first.evidence.log[i], i + 1, one);
    encode_record(second.evidence.log[i], i + 1, other);
    EXPECT_EQ(one, other) << "record " << i + 1;
  }
  EXPECT_NE(first.signature, run_scenario(shipped_scenario("quiet_hour"), true, {}).signature);
}

/// Each order's power while it was in force, summed; only energy that fits flows.
TEST(VirtualTime, TheEnergyOfADayIsWhatAHandCalculationSays) {
  const Scenario scenario = shipped_scenario("a_day_of_2023");
  const Outcome outcome = run_scenario(scenario, true, {});
  EXPECT_TRUE(outcome.passed()) << complaint(outcome);
  const BatteryParameters& p = scenario.battery.physics;
  const double efficiency = std::sqrt(0.9);
  double soc = 0.5, charged_wh = 0, discharged_wh = 0;
  const std::vector<DispatchEvent>& orders = outcome.evidence.orders;
  for (std::size_t i = 0; i + 1 < orders.size(); ++i) {
    const double hours = static_cast<double>(orders[i + 1].utc_ns - orders[i].utc_ns) / 3.6e12;
    const double wanted_wh = orders[i].power_w * hours;
    // The device keeps the limits of the order: 0.10 and 1.00.
    const double room_wh = (1.0 - soc) * p.capacity_wh / efficiency;
    const double stored_wh = (soc - 0.1) * p.capacity_wh * efficiency;
    const double flows_wh = wanted_wh > 0 ? std::min(wanted_wh, std::max(room_wh, 0.0))
                                          : std::max(wanted_wh, -std::max(stored_wh, 0.0));
    (flows_wh > 0 ? charged_wh : discharged_wh) += std::abs(flows_wh);
    soc += flows_wh > 0 ? flows_wh * efficiency / p.capacity_wh
                        : flows_wh / efficiency / p.capacity_wh;
  }
  double record_charged_wh = 0, record_discharged_wh = 0;
  for (const MinuteRecord& m : outcome.evidence.minutes) {
    (m.energy_wh > 0 ? record_charged_wh : record_discharged_wh) += std::abs(m.energy_wh);
  }
  EXPECT_GT(charged_wh, 10'000);
  // A minute with charge and discharge is one number of the record: at each reversal.
  EXPECT_NEAR(record_charged_wh - record_discharged_wh, charged_wh - discharged_wh,
              0.001 * charged_wh);
  EXPECT_NEAR(outcome.evidence.minutes.back().soc_frac, soc, 0.001);
}

TEST(VirtualTime, LeavesClockAndSignalsOfTheProcessAsTheyWere) {
  sigset_t before, after;
  pthread_sigmask(SIG_SETMASK, nullptr, &before);
  const std::int64_t wall_ns = clock_ns(CLOCK_REALTIME);
  EXPECT_TRUE(run_scenario(shipped_scenario("quiet_hour"), true, {}).passed());
  pthread_sigmask(SIG_SETMASK, nullptr, &after);
  EXPECT_EQ(sigismember(&before, SIGTERM), sigismember(&after, SIGTERM));
  EXPECT_GE(clock_ns(CLOCK_REALTIME), wall_ns);
  EXPECT_EQ(VirtualTime::current(), nullptr);
}

TEST(VirtualTime, DayAheadPricesNeedAStudentByOutlook) {
  Scenario scenario = shipped_scenario("quiet_hour");
  scenario.day_ahead.emplace();
  EXPECT_NE(run_scenario(scenario, true, {}).error.find("bess-hil-outlook"), std::string::npos);
}

TEST(VirtualTime, AScenarioOfTheOtherTimeIsSkippedAndSaysSo) {
  const Outcome outcome = run_scenario(shipped_scenario("disk_full"), true, {});
  EXPECT_NE(outcome.skipped, "");
}

}  // namespace
}  // namespace bess
