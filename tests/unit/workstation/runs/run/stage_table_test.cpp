// The table of stages: inputs exist before they are read.
#include "workstation/runs/run/run_stages.h"

#include <gtest/gtest.h>

#include <set>

namespace bess {
namespace {

TEST(StageTable, EachStageReadsWhatAnEarlierOneWrote) {
  std::set<std::string> written;
  int number = 0;
  for (const RunStages::Stage& stage : RunStages::stages()) {
    for (const std::string& input : stage.inputs) EXPECT_TRUE(written.contains(input)) << input;
    EXPECT_GE(stage.number, number) << stage.name;
    number = stage.number;
    written.insert(stage.outputs.begin(), stage.outputs.end());
  }
  EXPECT_EQ(RunStages::count(), number);
}

}  // namespace
}  // namespace bess
