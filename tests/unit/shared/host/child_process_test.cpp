// Child processes: handling of a signal after the child has been reaped.
#include "shared/host/child_process.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

/// A reaped child has no process id, and -1 would mean every process of this user: 0 only checks.
TEST(ChildProcess, ASignalToAnEndedChildReachesNoOtherProcess) {
  ChildProcess child({"/bin/cat", "/dev/null"});
  EXPECT_EQ(child.wait(), 0);
  EXPECT_TRUE(child.has_ended());
  EXPECT_FALSE(child.signal(0));
}

}  // namespace
}  // namespace bess
