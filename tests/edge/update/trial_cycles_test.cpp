// What the judge reads out of a controller's decision log, and which cycles of it are the new
// version's.
#include "edge/update/trial_cycles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "edge/log/log_text.h"
#include "shared/units_and_limits.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

using ::testing::SizeIs;

CycleRecord good_cycle(std::int64_t cycle) {
  CycleRecord record{};
  record.cycle = cycle;
  record.utc_s = 1'700'000'000 + 120 * cycle;
  record.mode = Mode::kRunning;
  record.reason = Reason::kStudent;
  record.battery_status = Status::kOk;
  record.price.status = Status::kOk;
  record.price.has_row = true;
  record.written = true;
  return record;
}

std::string csv_of(const std::vector<CycleRecord>& records) {
  char line[kLogLineBytes];
  format_csv_header(line);
  std::string csv = line;
  for (const CycleRecord& record : records) {
    format_csv_line(record, line);
    csv.append("\n").append(line);
  }
  return csv + "\n";
}

TrialCycle seen(const CycleRecord& record, bool must_write = true) {
  const std::vector<SeenCycle> cycles = cycles_of_csv(csv_of({record}), must_write);
  EXPECT_THAT(cycles, SizeIs(1));
  return cycles.at(0).cycle;
}

/// With the log's own writer: a column of another name would be no good cycle any more.
TEST(TrialCycles, AGoodCycleIsOneThatTheControllerWrote) {
  EXPECT_TRUE(seen(good_cycle(7)).is_good);
  CycleRecord silent = good_cycle(7);
  silent.written = false;
  EXPECT_FALSE(seen(silent).is_good);
  EXPECT_EQ(seen(silent).cause, TrialCause::kNone) << "the version's own";
  EXPECT_TRUE(seen(silent, false).is_good) << "the settings say control = false";
}

TEST(TrialCycles, EachTroubleOfTheSiteHasItsName) {
  struct Case {
    void (*spoil)(CycleRecord&);
    TrialCause cause;
  };
  const Case cases[] = {
      {[](CycleRecord& r) { r.battery_status = Status::kTimeout; }, TrialCause::kLink},
      {[](CycleRecord& r) { r.reason = Reason::kLink; }, TrialCause::kLink},
      {[](CycleRecord& r) { r.reason = Reason::kClock; }, TrialCause::kClock},
      {[](CycleRecord& r) { r.reason = Reason::kOffGrid; }, TrialCause::kOffGrid},
      {[](CycleRecord& r) { r.reason = Reason::kAlarm; }, TrialCause::kAlarm},
      {[](CycleRecord& r) { r.reason = Reason::kTemperature; }, TrialCause::kAlarm},
      {[](CycleRecord& r) { r.reason = Reason::kNoPrice; }, TrialCause::kPrice},
      {[](CycleRecord& r) { r.reason = Reason::kFrozenPrice; }, TrialCause::kPrice},
      {[](CycleRecord& r) { r.price.has_row = false; }, TrialCause::kPrice},
      {[](CycleRecord& r) { r.price.status = Status::kTimeout; }, TrialCause::kPrice},
      {[](CycleRecord& r) {
         r.is_tripped = true;
         r.trip.reason = Reason::kWrongDirection;
         r.battery_status = Status::kTimeout;
       },
       TrialCause::kTrip},
      {[](CycleRecord&) {}, TrialCause::kNone},
  };
  for (const Case& one : cases) {
    CycleRecord record = good_cycle(7);
    record.mode = Mode::kSafe;
    one.spoil(record);
    EXPECT_FALSE(seen(record).is_good);
    EXPECT_EQ(trial_cause_name(seen(record).cause), trial_cause_name(one.cause));
  }
}

TEST(TrialCycles, OnlyTheNewProcessCountsAndEachCycleOnce) {
  TrialState state;
  state.phase = TrialPhase::kTrying;
  const auto name_of = [](const CycleRecord& r) {
    return cycles_of_csv(csv_of({r}), true)[0].name;
  };
  state.mark = name_of(good_cycle(40));
  std::vector<CycleRecord> log = {good_cycle(39), good_cycle(40), good_cycle(41)};
  CycleRecord end = good_cycle(42);
  end.mode = Mode::kStopping;
  log.push_back(end);
  EXPECT_FALSE(count_new_cycles(state, cycles_of_csv(csv_of(log), true), {}));
  EXPECT_EQ(state.window, "") << "of the version before";
  end.cycle = 41;  // as it leaves: its last word bears the number of its last cycle
  end.utc_s += 10;
  log.push_back(end);
  EXPECT_FALSE(count_new_cycles(state, cycles_of_csv(csv_of(log), true), {}));
  EXPECT_FALSE(state.is_fresh) << "the next one has had no cycle";
  for (int i = 1; i <= 3; ++i) {
    log.push_back(good_cycle(i));
    log.back().utc_s = end.utc_s + 120 * i;
    EXPECT_TRUE(count_new_cycles(state, cycles_of_csv(csv_of(log), true), {}));
    EXPECT_FALSE(count_new_cycles(state, cycles_of_csv(csv_of(log), true), {}));
    EXPECT_EQ(state.good_cycles, i);
  }
}

TEST(TrialCycles, AProcessThatWasStoppedBeforeItsFirstCycleHidesNoneOfTheNext) {
  TrialState state;
  state.phase = TrialPhase::kTrying;
  CycleRecord end = good_cycle(5);
  end.mode = Mode::kStopping;
  end.cycle = 0;
  state.mark = cycles_of_csv(csv_of({end}), true)[0].name;
  std::vector<CycleRecord> log = {end};
  for (int i = 1; i <= 3; ++i) {
    log.push_back(good_cycle(i));
    log.back().utc_s = end.utc_s + 120 * i;
    EXPECT_TRUE(count_new_cycles(state, cycles_of_csv(csv_of(log), true), {}));
    EXPECT_EQ(state.good_cycles, i);
  }
}

TEST(TrialCycles, AProcessThatDiesIsACycleLostThoughTheNextOneGoesOn) {
  TrialState state;
  state.phase = TrialPhase::kTrying;
  std::vector<CycleRecord> log;
  const auto add = [&](std::int64_t number, bool is_end = false) {
    log.push_back(good_cycle(number));
    log.back().utc_s = 1'700'000'040 + 120 * static_cast<std::int64_t>(log.size());
    if (is_end) log.back().mode = Mode::kStopping;
    static_cast<void>(count_new_cycles(state, cycles_of_csv(csv_of(log), true), {}));
  };
  for (const std::int64_t number : {1, 2, 1, 1}) add(number);
  EXPECT_EQ(state.window, "110101");
  add(1, true);  // and one that is asked to end leaves its last word
  add(1);
  EXPECT_EQ(state.window, "1101011");
}

TEST(TrialCycles, AfterAFirstInstallationEverythingCounts) {
  TrialState state;
  state.phase = TrialPhase::kTrying;
  EXPECT_TRUE(count_new_cycles(state, cycles_of_csv(csv_of({good_cycle(1)}), true), {}));
  EXPECT_EQ(state.good_cycles, 1);
}

TEST(TrialCycles, MissedTicksAreToldOnceAndNotOverAStart) {
  CycleRecord late = good_cycle(9);
  late.missed_ticks = 6;
  CycleRecord first = good_cycle(8);
  first.missed_ticks = 4;
  CycleRecord started = good_cycle(1);
  started.missed_ticks = 1;
  const auto cycles = cycles_of_csv(csv_of({first, late, started}), true);
  EXPECT_EQ(cycles[0].cycle.missed_ticks, 0);
  EXPECT_EQ(cycles[1].cycle.missed_ticks, 2);
  EXPECT_EQ(cycles[2].cycle.missed_ticks, 0);
}

TEST(TrialCycles, WhatIsNoLogHasNoCycles) {
  for (const char* text : {"", "utc,cycle\n", "noise\nnoise\n", "utc,cycle,mode\n2023,1\n"}) {
    EXPECT_THAT(cycles_of_csv(text, true), SizeIs(0)) << text;
  }
}

TEST(TrialCycles, ControlIsWhatTheSettingsSay) {
  const TemporaryFolder folder;
  EXPECT_TRUE(wants_control(folder.write("a", "control = true\n[battery]\nunknown = 1\n")));
  EXPECT_FALSE(wants_control(folder.write("b", "control = false\n")));
  EXPECT_FALSE(wants_control(folder.write("c", "control = \n")));
  EXPECT_FALSE(wants_control(folder.file("absent")));
}

}  // namespace
}  // namespace bess
