// The judge of an upgrade, by a table: what was counted and seen, and the phase that follows.
#include "edge/update/trial.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bess {
namespace {

using ::testing::HasSubstr;

constexpr TrialLimits kLimits;

TrialState trying() {
  TrialState state;
  state.phase = TrialPhase::kTrying;
  state.version = "2.0";
  state.previous = "1.0";
  state.needed_cycles = kLimits.good_cycles;
  state.is_fresh = true;
  return state;
}

TrialState comparing(TrialCause cause) {
  TrialState state = trying();
  state.phase = TrialPhase::kComparing;
  state.bad_cause = trial_cause_name(cause);
  state.reason = "its cycles are lost";
  return state;
}

/// '1' a good cycle, '0' one that is lost by the version itself, and the first letter of what a
/// site may do.
TrialCycle cycle_of(char letter) {
  switch (letter) {
    case '1':
      return {.is_good = true};
    case 't':
      return {.cause = TrialCause::kTrip};
    case 'p':
      return {.cause = TrialCause::kPrice};
    case 'l':
      return {.cause = TrialCause::kLink};
    case 'o':
      return {.cause = TrialCause::kOffGrid};
    case 'c':
      return {.cause = TrialCause::kClock};
    case 'h':
      return {.cause = TrialCause::kHold};
    default:
      return {};
  }
}

std::string times(int count, const std::string& text) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

/// Two minutes each, until the phase changes.
TrialStep judge(TrialState state, const std::string& cycles) {
  TrialStep step{state.phase, ""};
  for (const char letter : cycles) {
    count_cycle(state, cycle_of(letter), kLimits);
    count_time(state, {}, 120);
    step = next_phase(state, {}, kLimits);
    if (step.phase != state.phase) break;
  }
  return step;
}

struct Case {
  const char* what;
  std::string shared;  ///< that the version before had as well
  std::string cycles;
  TrialPhase phase;
};

TEST(Trial, CyclesOfANewVersion) {
  const Case cases[] = {
      {"all good", "", times(15, "1"), TrialPhase::kConfirmed},
      {"one too few", "", times(14, "1"), TrialPhase::kTrying},
      {"three lost among eighteen", "",
       "0" + times(7, "1") + "0" + times(4, "1") + "0" + times(4, "1"), TrialPhase::kConfirmed},
      {"each second is lost", "", times(30, "10"), TrialPhase::kGoingBack},
      {"each fourth is lost", "", times(16, "1110"), TrialPhase::kGoingBack},
      {"it writes nothing", "", times(30, "0"), TrialPhase::kGoingBack},
      {"the price is away for it", "", times(5, "p"), TrialPhase::kComparing},
      {"the battery is away for it", "", times(5, "l"), TrialPhase::kComparing},
      {"off the grid", "", times(5, "o"), TrialPhase::kComparing},
      {"the clock is not set", "", times(5, "c"), TrialPhase::kComparing},
      {"a passing outage", "", times(10, "1") + times(4, "p") + times(15, "1"),
       TrialPhase::kConfirmed},
      {"it trips", "", "111" + times(5, "t"), TrialPhase::kGoingBack},
      {"a trip from before", "trip", times(700, "t"), TrialPhase::kTrying},
      {"a price that was away before", "price", times(25, "p"), TrialPhase::kTrying},
      {"and comes", "price", times(25, "p") + times(15, "1"), TrialPhase::kConfirmed},
      {"after an hour one looks again", "price", times(31, "p"), TrialPhase::kComparing},
      {"then it is its own again", "price", times(5, "p") + "1" + times(5, "p"),
       TrialPhase::kComparing},
      {"what rests does not hide another", "price", times(3, "p") + times(5, "l"),
       TrialPhase::kComparing},
      {"a rest ends with its cause", "link", times(9, "l") + times(30, "1l"),
       TrialPhase::kGoingBack},
      {"a hold of days", "", "1" + times(700, "h") + times(14, "1"), TrialPhase::kConfirmed},
      {"it loses its link each second cycle", "", times(30, "1l"), TrialPhase::kGoingBack},
  };
  for (const Case& one : cases) {
    TrialState state = trying();
    state.shared = one.shared;
    EXPECT_EQ(trial_phase_name(judge(state, one.cycles).phase), trial_phase_name(one.phase))
        << one.what;
  }
}

TEST(Trial, WithoutAVersionBeforeThereIsNoneToGoBackTo) {
  TrialState state = trying();
  state.previous.clear();
  EXPECT_EQ(judge(state, times(30, "0")).phase, TrialPhase::kFailed);
  EXPECT_EQ(judge(state, times(20, "p") + times(15, "1")).phase, TrialPhase::kConfirmed);
}

TEST(Trial, TheVersionBeforeTellsWhoseFaultItIs) {
  EXPECT_EQ(judge(comparing(TrialCause::kPrice), "pp").phase, TrialPhase::kComparing);
  const TrialStep same = judge(comparing(TrialCause::kPrice), "ppp");
  EXPECT_EQ(same.phase, TrialPhase::kTrying);
  EXPECT_EQ(same.cause, TrialCause::kPrice);
  EXPECT_EQ(judge(comparing(TrialCause::kPrice), "1").phase, TrialPhase::kTrying)
      << "the first time it may be chance";
  TrialState twice = comparing(TrialCause::kPrice);
  twice.worse = 1;
  const TrialStep better = judge(twice, "1");
  EXPECT_EQ(better.phase, TrialPhase::kGoingBack);
  EXPECT_THAT(better.reason, HasSubstr("not so 1.0"));
  // Another trouble is not that one.
  EXPECT_EQ(judge(twice, "l").phase, TrialPhase::kGoingBack);
  EXPECT_EQ(judge(comparing(TrialCause::kNoStart), "1").phase, TrialPhase::kGoingBack);
  EXPECT_EQ(judge(comparing(TrialCause::kNoStart), "l").phase, TrialPhase::kGoingBack);
}

TEST(Trial, ATroubleThatEndsWhileOneComparesWasTheSites) {
  for (const char* const cycles : {"p1", "pp1"}) {
    const TrialStep over = judge(comparing(TrialCause::kPrice), cycles);
    EXPECT_EQ(over.phase, TrialPhase::kTrying) << cycles;
    EXPECT_EQ(over.cause, TrialCause::kNone) << "and it is not excused from now on";
  }
  TrialState often = comparing(TrialCause::kPrice);
  often.passed = kPassedMax;
  EXPECT_EQ(judge(often, "p1").phase, TrialPhase::kGoingBack);
  // A version before that did not start at first, and then does.
  TrialState silent = comparing(TrialCause::kNoStart);
  count_restarts(silent, {.restarts = 0});
  EXPECT_EQ(judge(silent, "1").phase, TrialPhase::kGoingBack);
  count_restarts(silent, {.restarts = 1});
  EXPECT_EQ(next_phase(silent, {}, kLimits).phase, TrialPhase::kComparing);
  EXPECT_EQ(judge(silent, "1").phase, TrialPhase::kTrying);
  TrialState priceless = comparing(TrialCause::kPrice);
  priceless.worse = 1;
  count_restarts(priceless, {.restarts = 1});
  EXPECT_EQ(judge(priceless, "1").phase, TrialPhase::kGoingBack);
}

TEST(Trial, AVersionThatDoesNotStartIsComparedAtOnce) {
  for (const TrialUnit unit : {TrialUnit{.has_failed = true}, TrialUnit{.restarts = 6}}) {
    EXPECT_EQ(next_phase(trying(), unit, kLimits).phase, TrialPhase::kComparing);
    EXPECT_EQ(next_phase(trying(), unit, kLimits).cause, TrialCause::kNoStart);
    // The version before does not either: the site.
    EXPECT_EQ(next_phase(comparing(TrialCause::kNoStart), unit, kLimits).phase,
              TrialPhase::kTrying);
    TrialState shared = trying();
    share(shared, TrialCause::kNoStart);
    EXPECT_EQ(next_phase(shared, unit, kLimits).phase, TrialPhase::kTrying);
    count_time(shared, unit, kLimits.deadline_s);
    EXPECT_EQ(next_phase(shared, unit, kLimits).phase, TrialPhase::kComparing) << "after an hour";
  }
  EXPECT_EQ(next_phase(trying(), {.restarts = 5}, kLimits).phase, TrialPhase::kTrying);
}

TEST(Trial, AVersionWithoutACycleIsComparedWhileTheOrderFromBeforeIsInForce) {
  TrialState state = trying();
  state.is_fresh = false;
  count_time(state, {}, kLimits.first_cycle_s - 1);
  EXPECT_EQ(next_phase(state, {}, kLimits).phase, TrialPhase::kTrying);
  count_time(state, {}, 1);
  EXPECT_EQ(next_phase(state, {}, kLimits).phase, TrialPhase::kComparing);
  EXPECT_EQ(next_phase(state, {}, kLimits).cause, TrialCause::kNoCycle);
  TrialState first = state;
  first.previous.clear();
  EXPECT_EQ(next_phase(first, {}, kLimits).phase, TrialPhase::kTrying) << "there is none before";
  state.is_fresh = true;
  EXPECT_EQ(next_phase(state, {}, kLimits).phase, TrialPhase::kTrying) << "it had one";
  TrialState again = comparing(TrialCause::kNoCycle);
  EXPECT_EQ(judge(again, "1").phase, TrialPhase::kTrying) << "maybe by chance";
  again.worse = 1;
  EXPECT_EQ(judge(again, "1").phase, TrialPhase::kGoingBack);
  count_restarts(again, {.restarts = 1});
  EXPECT_EQ(judge(again, "1").phase, TrialPhase::kTrying) << "it did not start at first either";
}

TEST(Trial, EachPhaseHasAnEnd) {
  TrialState upgrading = trying();
  upgrading.phase = TrialPhase::kUpgrading;
  EXPECT_EQ(running_version(upgrading), "") << "what runs is left as it is";
  count_time(upgrading, {.is_stopped = true}, kLimits.upgrade_s);
  EXPECT_EQ(next_phase(upgrading, {.is_stopped = true}, kLimits).phase, TrialPhase::kRolledBack);
  TrialState slow = trying();
  count_time(slow, {}, kLimits.deadline_s);
  EXPECT_EQ(next_phase(slow, {}, kLimits).phase, TrialPhase::kGoingBack);
  TrialState both_silent = comparing(TrialCause::kLink);
  count_time(both_silent, {}, kLimits.deadline_s);
  EXPECT_EQ(next_phase(both_silent, {}, kLimits).phase, TrialPhase::kGoingBack);
  TrialState rebooted = trying();
  rebooted.boots = kLimits.boots + 1;
  EXPECT_EQ(next_phase(rebooted, {}, kLimits).phase, TrialPhase::kGoingBack);
}

TEST(Trial, APersonsStopRests) {
  TrialState state = trying();
  count_time(state, {.is_stopped = true}, 10 * kLimits.deadline_s);
  EXPECT_EQ(next_phase(state, {.is_stopped = true}, kLimits).phase, TrialPhase::kTrying);
}

TEST(Trial, MissedTicksAreLostCycles) {
  TrialState state = trying();
  for (int i = 0; i < 12; ++i) count_cycle(state, {.is_good = true}, kLimits);
  count_cycle(state, {.is_good = true, .missed_ticks = 5}, kLimits);
  EXPECT_EQ(state.good_cycles, 13);
  EXPECT_EQ(state.window, times(12, "1") + "00000" + "1");
  count_cycle(state, {.is_good = true, .missed_ticks = INT64_MAX}, kLimits);
  EXPECT_EQ(state.good_cycles, 1);
}

TEST(Trial, NotWorseThanTheVersionBefore) {
  const auto before = [](const std::string& letters) {
    std::vector<TrialCycle> cycles;
    for (const char letter : letters) cycles.push_back(cycle_of(letter));
    return needed_good_cycles(cycles, kLimits);
  };
  EXPECT_EQ(before(""), 15);
  EXPECT_EQ(before(times(17, "1")), 15) << "too few to compare with";
  EXPECT_EQ(before(times(18, "1")), 17);
  EXPECT_EQ(before("l" + times(17, "1")), 16);
  EXPECT_EQ(before(times(20, "0") + times(18, "1")), 17) << "the last ones count";
  EXPECT_EQ(before(times(6, "l11")), 12) << "a site where each third is lost";
  EXPECT_EQ(before(times(18, "p")), 15) << "something was away";
}

TEST(Trial, WhatRunsAndWhoJudgesFollowFromThePhase) {
  struct Row {
    TrialPhase phase;
    std::string running;
    std::string judging;
  };
  for (const Row& row :
       {Row{TrialPhase::kUnknown, "", ""}, Row{TrialPhase::kUpgrading, "", ""},
        Row{TrialPhase::kTrying, "2.0", "1.0"}, Row{TrialPhase::kComparing, "1.0", "1.0"},
        Row{TrialPhase::kGoingBack, "1.0", "1.0"}, Row{TrialPhase::kConfirmed, "2.0", "2.0"},
        Row{TrialPhase::kRolledBack, "2.0", "2.0"}, Row{TrialPhase::kFailed, "2.0", ""}}) {
    TrialState state = trying();
    state.phase = row.phase;
    EXPECT_EQ(running_version(state), row.running) << trial_phase_name(row.phase);
    EXPECT_EQ(judging_version(state), row.judging) << trial_phase_name(row.phase);
    EXPECT_EQ(trial_phase_of(trial_phase_name(row.phase)), row.phase);
  }
}

}  // namespace
}  // namespace bess
