// The table of stages against what is written about it, and against the files that a run knows.
#include "workstation/runs/run/run_stages.h"

#include <gmock/gmock.h>

#include <set>

#include "shared/host/file.h"
#include "shared/host/text.h"

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

/// The README's line that begins with the stage names each of its files.
TEST(StageTable, TheReadmeTellsWhatEachStageWrites) {
  const std::string readme = read_file(BESS_SOURCE_DIR "/workstation/README.md");
  const std::size_t begin = readme.find("| stage | writes |");
  ASSERT_NE(begin, readme.npos);
  const std::string table = readme.substr(begin, readme.find("\n\n", begin) - begin);
  for (const RunStages::Stage& stage : RunStages::stages()) {
    if (stage.when == RunStages::When::kAfterFailedProof) continue;  // the same files
    std::string_view left = table;
    std::string_view row;
    while (!left.empty() && row.empty()) {
      const std::string_view line = take_line(left);
      if (line.substr(0, line.find('|', 1)).find(stage.name) != line.npos) row = line;
    }
    ASSERT_FALSE(row.empty()) << stage.name;
    for (const std::string& file : stage.outputs) {
      EXPECT_THAT(std::string(row), testing::HasSubstr("`" + file + "`"));
    }
  }
}

}  // namespace
}  // namespace bess
