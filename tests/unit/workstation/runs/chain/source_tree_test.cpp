#include <gtest/gtest.h>

#include "shared/host/file.h"
#include "tests/support/temporary_folder.h"
#include "workstation/runs/chain/common_options.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

TEST(SourceTree, IsFoundFromAnyFolderInIt) {
  const TemporaryFolder folder;
  const fs::path tree = folder.file("bess");
  write_file(tree / "edge/CMakeLists.txt", "");
  write_file(tree / "edge/generated/student_weights.h", "");
  fs::create_directories(tree / "build/deep");
  for (const fs::path& at : {tree, tree / "edge", tree / "build/deep"}) {
    EXPECT_EQ(header_in_tree_around(at), tree / "edge/generated/student_weights.h") << at;
  }
  EXPECT_EQ(header_in_tree_around(folder.file("")), std::nullopt);
}

TEST(SourceTree, AFolderThatOnlyLooksLikeItIsNone) {
  const TemporaryFolder folder;  // remains of an export into the wrong folder
  write_file(folder.file("edge/generated/student_weights.h"), "");
  EXPECT_EQ(header_in_tree_around(folder.file(".")), std::nullopt);
  EXPECT_EQ(header_in_tree_around("/"), std::nullopt);
  EXPECT_EQ(header_in_tree_around(""), std::nullopt);
}

}  // namespace
}  // namespace bess
