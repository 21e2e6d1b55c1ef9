// From classes of sites to packages and an inventory, with a simulated tools/package: results,
// unchanged files, and refusals. tests/system/guest/classes has the real one.
#include "workstation/runs/sweep/collected.h"

#include <gmock/gmock.h>

#include <fmt/format.h>

#include <filesystem>

#include "shared/host/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kPackaging = R"sh(#!/bin/sh
# tools/package --student FOLDER --class NAME ARCH...
folder=$2 class=$4; shift 4
[ "$(cat "$folder/student_weights.h")" != bad ] ||
  { echo one; echo "tools/package: no compiler"; exit 1; }
echo "student=0a0b0c0d decisions=1" >"$folder/decision_signature.txt"
for arch; do echo >"$folder/bess-edge_0.1.0+2026.g1.${class}_$arch.deb"; done
)sh";

class ClassPackages : public testing::Test {
 protected:
  ClassPackages() {
    const fs::path package = request_.source / "tools/package";
    write_file(package, kPackaging);
    fs::permissions(package, fs::perms::owner_all);
  }
  /// A site whose class's student is `header`, which is written; empty: none.
  CollectedSite site(const std::string& id, const std::string& of, const std::string& header) {
    CollectedSite one{{id, "", 4000, 8000, of}, 1, header.empty() ? 0 : 1, 406.25};
    if (header.empty()) return one;
    one.header = of + "/student_weights.h";
    write_file(folder_.path / one.header, header);
    return one;
  }

  TemporaryFolder root_;
  SweepFolder folder_{root_.file("sweep")};
  PackageRequest request_{root_.file("source"), root_.file("debs"), {"arm64", "armhf"}};
};

TEST_F(ClassPackages, OneAClassAndAgainOnlyWhereItsStudentIsAnother) {
  const std::vector<CollectedSite> sites{site("b", "22", "two"), site("a", "11", "one"),
                                         site("c", "22", "two")};
  auto classes = classes_to_package({}, sites, false);
  ASSERT_EQ(classes.size(), 2);
  EXPECT_EQ(classes[0].name, "22") << "in the order of their first site";
  for (PackagedClass& one : classes) EXPECT_TRUE(package_class(folder_, request_, one));
  EXPECT_EQ(classes[0].student, "0a0b0c0d");
  EXPECT_EQ(classes[0].version, "0.1.0+2026.g1.22");
  EXPECT_TRUE(fs::exists(request_.out / "11/bess-edge_0.1.0+2026.g1.11_armhf.deb"));

  for (PackagedClass& one : classes) EXPECT_FALSE(package_class(folder_, request_, one));
  fs::remove(request_.out / "11/bess-edge_0.1.0+2026.g1.11_armhf.deb");
  EXPECT_FALSE(package_class(folder_, request_, classes[0]));
  EXPECT_TRUE(package_class(folder_, request_, classes[1])) << "one architecture is missing";
  write_file(request_.out / "22/bess-edge_9_arm64.deb", "of the student before");
  write_file(folder_.path / "22/student_weights.h", "retrained");
  EXPECT_TRUE(package_class(folder_, request_, classes[0]));
  EXPECT_EQ(classes[0].version, "0.1.0+2026.g1.22") << "no file of the previous student is left";
  write_file(request_.out / "22/bess-edge_0.1.0+2026.g10.22_arm64.deb", "newer");
  EXPECT_FALSE(package_class(folder_, request_, classes[0]));
  EXPECT_EQ(classes[0].version, "0.1.0+2026.g10.22");
}

TEST_F(ClassPackages, TheInventoryHasEachSiteInItsClassAndInOneShare) {
  std::vector<PackagedClass> classes{{"22", {site("site-184", "22", "x")}, "0a0b0c0d", "1.g1.22"},
                                     {"11", {site("site-2", "11", "x")}, "00000001", "1.g1.11"}};
  EXPECT_EQ(format_inventory(classes, "armhf").substr(0, 10), "# Written ");
  EXPECT_THAT(
      format_inventory(classes, "armhf"),
      testing::AllOf(HasSubstr("all:\n  vars: {bess_architecture: armhf}\n  children:\n"),
                     HasSubstr("    class_22:\n      vars:\n        bess_class: \"22\"\n"
                               "        bess_expected_student: \"0a0b0c0d\"\n"
                               "        bess_package: \"{{ inventory_dir }}/22/"
                               "bess-edge_1.g1.22_{{ bess_architecture }}.deb\"\n"
                               "      hosts:\n"
                               "        \"site-184\": {bess_expected_eur_per_day: 3.2500}\n"),
                     testing::EndsWith("    rollout_1:\n      hosts:\n        \"site-184\":\n"
                                       "    rollout_10:\n      hosts:\n        \"site-2\":\n"
                                       "    rollout_100:\n      hosts: {}\n")));
}

TEST_F(ClassPackages, SharesAreAHundredthATenthAndTheRest) {
  int first = 0, tenth = 0;
  for (int i = 1; i <= 10'000; ++i) {
    const int percent = rollout_percent(fmt::format("site-{}", i));
    first += percent == 1 ? 1 : 0;
    tenth += percent <= 10 ? 1 : 0;
  }
  EXPECT_NEAR(first, 100, 30);  // three standard deviations
  EXPECT_NEAR(tenth, 1000, 90);
}

TEST_F(ClassPackages, WhatCannotBeIsRefusedInOneLine) {
  const auto refusal = [&](const std::vector<CollectedSite>& sites) {
    return refusal_of([&] { classes_to_package({}, sites, false); });
  };
  EXPECT_THAT(refusal({site("a", "11", "x"), site("b", "22", "")}), Names("\"b\" 1 22 --partial"));
  EXPECT_EQ(classes_to_package({}, {site("a", "11", "x"), site("b", "22", "")}, true).size(), 1);
  EXPECT_THAT(refusal({site("a b", "11", "x")}), Names("\"a b\""));
  const CollectedTask of_march{{1, {{"fold", "2023-03"}}}, TaskState::kProved, {}, 0};
  EXPECT_THAT(refusal_of([&] { classes_to_package({of_march}, {}, false); }), testing::Ne(""));

  auto classes = classes_to_package({}, {site("a", "11", "bad")}, false);
  EXPECT_THAT(refusal_of([&] { package_class(folder_, request_, classes[0]); }),
              Names("11 tools/package: no compiler"));
  write_file(folder_.path / "11/student_weights.h", "good");
  EXPECT_TRUE(package_class(folder_, request_, classes[0])) << "an interrupted build is no package";
}

}  // namespace
}  // namespace bess
