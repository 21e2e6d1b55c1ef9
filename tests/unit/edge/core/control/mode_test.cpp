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
  const Row table[] = {
      {Mode::kStart, false, false, false, false, false, Mode::kRunning},
      {Mode::kStart, false, true, false, false, false, Mode::kStart},
      {Mode::kStart, false, true, true, false, false,
       Mode::kStart},  // nothing was ordered: nothing to hold
      {Mode::kStart, false, true, false, false, true, Mode::kHolding},  // of the run before
      {Mode::kStart, false, false, false, false, true, Mode::kRunning},
      {Mode::kSafe, false, true, true, false, true, Mode::kSafe},
      {Mode::kRunning, false, false, true, false, false, Mode::kRunning},
      {Mode::kRunning, false, true, false, false, false, Mode::kHolding},
      {Mode::kRunning, false, true, true, false, false,
       Mode::kHolding},  // 0 W is always held first
      {Mode::kHolding, false, false, false, false, false, Mode::kRunning},
      {Mode::kHolding, false, true, false, false, false, Mode::kHolding},
      {Mode::kHolding, false, true, true, false, false, Mode::kSafe},
      {Mode::kSafe, false, true, true, false, false, Mode::kSafe},
      {Mode::kSafe, false, true, false, false, false, Mode::kSafe},
      {Mode::kSafe, false, false, false, false, false, Mode::kRunning},
      // Off-grid: 0 W is not held.
      {Mode::kRunning, false, true, false, true, false, Mode::kSafe},
      {Mode::kHolding, false, true, false, true, false, Mode::kSafe},
      {Mode::kStart, false, true, false, true, true, Mode::kSafe},
      {Mode::kStart, false, true, false, true, false, Mode::kStart},
      {Mode::kStopping, false, false, false, false, false, Mode::kStopping},  // final
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
