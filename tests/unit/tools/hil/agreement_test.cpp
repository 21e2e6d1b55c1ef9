// Comparison of virtual and wall time: which control cycles count, and which orders are equal.
#include "tools/hil_runner/run/agreement.h"

#include <gmock/gmock.h>

#include "tests/support/tokens.h"
#include "tools/hil_runner/wall/wall_run.h"

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
  CycleRecord elsewhere = cycle(6, -4'011);
  elsewhere.price.has_row = true;
  const std::vector<Outcome> runs = {
      outcome(true, {cycle(2, 4'000), cycle(4, 4'000), cycle(6, -4'000), cycle(8, 0),
                     cycle(9, 0, Mode::kStopping)}),
      outcome(false, {cycle(0, 1), cycle(2, 4'010), elsewhere, cycle(8, 0),
                      cycle(9, 7'000, Mode::kStopping)})};
  const std::vector<Agreement> found = agreements_of(runs);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].cycles, 3);
  ASSERT_EQ(found[0].otherwise.size(), 1U);
  EXPECT_EQ(found[0].otherwise[0].met, "price");
  EXPECT_TRUE(found[0].holds());
  EXPECT_THAT(agreement_line(found), Names("2 3 1 0"));
  EXPECT_THAT(agreement_table(found), Names("6 -4000 W student -4011 price"));
}

TEST(Agreement, AnotherOrderOnTheSameBreaksIt) {
  const auto with = [](const auto& change) {
    CycleRecord record = cycle(2, 0);
    change(record);
    const std::vector<Agreement> found =
        agreements_of({outcome(true, {cycle(2, 4'000)}), outcome(false, {record})});
    return found.at(0).holds() ? found.at(0).otherwise.at(0).met : "broken";
  };
  EXPECT_EQ(with([](CycleRecord&) {}), "broken");
  EXPECT_EQ(with([](CycleRecord& r) { r.decision_us = 7; }), "broken");
  EXPECT_EQ(with([](CycleRecord& r) { r.has_measurement = true; }), "link");
  EXPECT_EQ(with([](CycleRecord& r) { r.price.minute_utc_s = 60; }), "price");
  EXPECT_EQ(with([](CycleRecord& r) { r.hold.held = true; }), "words");
  EXPECT_EQ(with([](CycleRecord& r) { r.site.has_grid_power = true; }), "meter");
  EXPECT_EQ(with([](CycleRecord& r) { r.measurement.soc_e4 = 1; }), "battery");
  EXPECT_EQ(with([](CycleRecord& r) { r.is_tripped = true; }), "before");
}

TEST(Agreement, SaysNothingWhereNothingRanInBothTimes) {
  EXPECT_EQ(agreement_line(agreements_of({outcome(true, {cycle(2, 0)})})), "");
  Outcome skipped = outcome(false, {cycle(2, 0)});
  skipped.skipped = "for virtual time";
  EXPECT_EQ(agreement_line(agreements_of({outcome(true, {cycle(2, 0)}), skipped})), "");
  Outcome late = outcome(false, {});
  late.error = std::string(kTooLate) + " by 3 s";
  EXPECT_TRUE(agreements_of({outcome(true, {cycle(2, 0)}), late}).at(0).holds());
  late.error = "bess-edge does not start";
  EXPECT_FALSE(agreements_of({outcome(true, {cycle(2, 0)}), late}).at(0).holds());
}

}  // namespace
}  // namespace bess
