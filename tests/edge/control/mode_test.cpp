// The mode state machine, every mode against every input.
#include "edge/control/mode.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

struct Row {
  Mode from;
  bool stop_requested, stop_reason, hold_elapsed, order_found;
  Mode to;
};

TEST(Mode, EveryTransition) {
  const Row table[] = {
      {Mode::kStart, false, false, false, false, Mode::kRunning},
      {Mode::kStart, false, true, false, false, Mode::kStart},
      {Mode::kStart, false, true, true, false,
       Mode::kStart},  // nothing was ordered: nothing to hold
      {Mode::kStart, false, true, false, true, Mode::kHolding},  // of the run before
      {Mode::kStart, false, false, false, true, Mode::kRunning},
      {Mode::kSafe, false, true, true, true, Mode::kSafe},
      {Mode::kRunning, false, false, true, false, Mode::kRunning},
      {Mode::kRunning, false, true, false, false, Mode::kHolding},
      {Mode::kRunning, false, true, true, false, Mode::kHolding},  // 0 W is always held first
      {Mode::kHolding, false, false, false, false, Mode::kRunning},
      {Mode::kHolding, false, true, false, false, Mode::kHolding},
      {Mode::kHolding, false, true, true, false, Mode::kSafe},
      {Mode::kSafe, false, true, true, false, Mode::kSafe},
      {Mode::kSafe, false, true, false, false, Mode::kSafe},
      {Mode::kSafe, false, false, false, false, Mode::kRunning},
      {Mode::kStopping, false, false, false, false, Mode::kStopping},  // final
  };
  for (const Row& row : table) {
    EXPECT_EQ(next_mode(row.from,
                        {row.stop_requested, row.stop_reason, row.hold_elapsed, row.order_found}),
              row.to)
        << mode_name(row.from) << " reason " << row.stop_reason << " hold " << row.hold_elapsed;
  }
}

TEST(Mode, AStopRequestWinsEverywhere) {
  for (const Mode from :
       {Mode::kStart, Mode::kRunning, Mode::kHolding, Mode::kSafe, Mode::kStopping}) {
    for (const bool reason : {false, true}) {
      EXPECT_EQ(next_mode(from, {true, reason, false, false}), Mode::kStopping) << mode_name(from);
    }
  }
}

}  // namespace
}  // namespace bess
