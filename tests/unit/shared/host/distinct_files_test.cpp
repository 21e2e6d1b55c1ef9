// Identity of files under different names.
#include "shared/host/file.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/user_error_of.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

class DistinctFiles : public testing::Test {
 protected:
  DistinctFiles() { fs::create_directory(folder_.file("sub")); }

  static std::string refusal(const std::vector<NamedPath>& outputs,
                             const std::vector<NamedPath>& inputs) {
    return refusal_of([&] { require_distinct(outputs, inputs); });
  }

  TemporaryFolder folder_;
  std::string input_ = folder_.write("prices.csv", "prices");
};

TEST_F(DistinctFiles, AnOutputThatIsAnInputIsRefusedUnderAnyName) {
  const std::string link = folder_.file("link.csv");
  fs::create_symlink(input_, link);
  const std::string linked_folder = folder_.file("elsewhere");
  fs::create_directory_symlink(folder_.file(""), linked_folder);
  for (const std::string& name : {input_, link, folder_.file("sub/../prices.csv"),
                                  linked_folder + "/prices.csv", fs::relative(input_).string()}) {
    EXPECT_EQ(
        refusal({{"--out", name}}, {{"--config", ""}, {"--prices", input_}}),
        "--out " + name + ": would replace the input --prices " + input_ + "; use another name");
  }
}

TEST_F(DistinctFiles, TwoOutputsThatWillBeOneFileAreRefused) {
  const std::string later = folder_.file("later.csv");  // does not exist yet
  EXPECT_NE(refusal({{"--csv", later}, {"--days-out", folder_.file("sub/../later.csv")}}, {}), "");
}

TEST_F(DistinctFiles, OthersDevicesAndWhatIsNotGivenPass) {
  EXPECT_EQ(refusal({{"--csv", folder_.file("a.csv")}, {"--out", ""}, {"--curve-out", ""}},
                    {{"--prices", input_}, {"--config", ""}}),
            "");
  EXPECT_EQ(
      refusal({{"--csv", "/dev/null"}, {"--days-out", "/dev/null"}}, {{"--fit", "/dev/null"}}), "");
}

}  // namespace
}  // namespace bess
