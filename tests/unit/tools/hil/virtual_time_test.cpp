// Runs in virtual time: they are bit-identical when repeated, and the process state is unchanged.
#include "tools/hil_runner/virtual/virtual_time.h"

#include <gtest/gtest.h>
#include <signal.h>

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
