// Programs that are started: what becomes of a signal when nobody is left to take it.
#include "shared/host/child_process.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

/// Once it was waited for it has no number any more, and -1 would mean every process of this user:
/// 0 only asks.
TEST(ChildProcess, ASignalToOneThatHasEndedReachesNobodyElse) {
  ChildProcess child({"/bin/cat", "/dev/null"});
  EXPECT_EQ(child.wait(), 0);
  EXPECT_TRUE(child.has_ended());
  EXPECT_FALSE(child.signal(0));
}

TEST(ChildProcess, RunsUntilItIsSignalled) {
  ChildProcess child({"/bin/sleep", "60"});
  EXPECT_FALSE(child.has_ended());
  EXPECT_TRUE(child.signal(SIGTERM));
  EXPECT_EQ(child.wait(), 128 + SIGTERM);
}

}  // namespace
}  // namespace bess
