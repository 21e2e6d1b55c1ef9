// The mode state machine, every mode against every input.
#include "edge/core/control/tick.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

struct Row {
  Mode from;
  bool stop_requested, stop_reason, hold_elapsed, release_now, order_found;
  Mode to;
};

TEST(Mode, EveryTransition) {
  using enum Mode;
  const Row table[] = {
      {kStart, false, false, false, false, false, kRunning},
      {kStart, false, true, false, false, false, kStart},
      {kStart, false, true, true, false, false, kStart},    // nothing was ordered: nothing to hold
      {kStart, false, true, false, false, true, kHolding},  // of the previous run
      {kStart, false, false, false, false, true, kRunning},
      {kSafe, false, true, true, false, true, kSafe},
      {kRunning, false, false, true, false, false, kRunning},
      {kRunning, false, true, false, false, false, kHolding},
      {kRunning, false, true, true, false, false, kHolding},  // 0 W is always held first
      {kHolding, false, false, false, false, false, kRunning},
      {kHolding, false, true, false, false, false, kHolding},
      {kHolding, false, true, true, false, false, kSafe},
      {kSafe, false, true, true, false, false, kSafe},
      {kSafe, false, true, false, false, false, kSafe},
      {kSafe, false, false, false, false, false, kRunning},
      // Off-grid: 0 W is not held.
      {kRunning, false, true, false, true, false, kSafe},
      {kHolding, false, true, false, true, false, kSafe},
      {kStart, false, true, false, true, true, kSafe},
      {kStart, false, true, false, true, false, kStart},
      {kStopping, false, false, false, false, false, kStopping},  // final
  };
  for (const Row& row : table) {
    EXPECT_EQ(next_mode(row.from, {row.stop_requested, row.stop_reason, row.hold_elapsed,
                                   row.release_now, row.order_found}),
              row.to)
        << mode_name(row.from) << " reason " << row.stop_reason << " hold " << row.hold_elapsed;
  }
}

TEST(Mode, AStopRequestWinsEverywhere) {
  for (const Mode from :
       {Mode::kStart, Mode::kRunning, Mode::kHolding, Mode::kSafe, Mode::kStopping}) {
    for (const bool reason : {false, true}) {
      EXPECT_EQ(next_mode(from, {true, reason, false, false, false}), Mode::kStopping)
          << mode_name(from);
    }
  }
}

}  // namespace
}  // namespace bess
