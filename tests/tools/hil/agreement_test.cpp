// Virtual and wall time held against each other: which cycles count, and what is the same order.
#include "tools/hil_runner/run/agreement.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

CycleRecord cycle(int minute, std::int32_t power_w, Mode mode = Mode::kRunning) {
  CycleRecord logged;
  logged.utc_s = 60 * minute;
  logged.mode = mode;
  logged.ordered_power_w = power_w;
  logged.reason = Reason::kStudent;
  return logged;
}

Outcome outcome(bool is_virtual, std::vector<CycleRecord> log) {
  Outcome run;
  run.scenario.name = run.scenario.path = "made up";
  run.is_virtual = is_virtual;
  run.evidence.log = std::move(log);
  return run;
}

TEST(Agreement, ComparesWhatBothHaveLogged) {
  const std::vector<Outcome> runs = {
      outcome(true, {cycle(2, 4'000), cycle(4, 4'000), cycle(6, -4'000), cycle(8, 0),
                     cycle(9, 0, Mode::kStopping)}),
      outcome(false, {cycle(0, 1), cycle(2, 4'010), cycle(6, -4'011), cycle(8, 0),
                      cycle(9, 7'000, Mode::kStopping)})};
  const Agreement found = agreement_of(runs);
  EXPECT_EQ(found.scenarios, 1);
  EXPECT_EQ(found.cycles, 3);
  EXPECT_EQ(found.otherwise, 1);
  EXPECT_EQ(agreement_line(found),
            "2 of 3 cycles of 1 scenarios ordered alike in both times; not made up at minute 6: "
            "-4000 W (student), in wall time -4011 W (student)");
}

TEST(Agreement, SaysNothingWhereNothingRanInBothTimes) {
  EXPECT_EQ(agreement_line(agreement_of({outcome(true, {cycle(2, 0)})})), "");
  Outcome skipped = outcome(false, {cycle(2, 0)});
  skipped.skipped = "for virtual time";
  EXPECT_EQ(agreement_line(agreement_of({outcome(true, {cycle(2, 0)}), skipped})), "");
}

}  // namespace
}  // namespace bess
