// Stored sign check: its binding, and the text shown when it does not fit.
#include "edge/app/storage/commission_file.h"

#include <gmock/gmock.h>

#include "tests/support/as_nobody.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

class CommissionFile : public ::testing::Test {
 protected:
  CommissionFile() {
    config_.battery.map.name = "simulator";
    config_.battery.map.variant = "block";
    config_.battery.map_path.assign(folder_.write("map.toml", "# version 1\n"));
    config_.state.folder.assign(folder_.file("state"));
    EXPECT_TRUE(write_commission_file(
        config_,
        {.verdict = CommissionVerdict::kPassed, .ordered_power_w = 500, .measured_power_w = 493},
        1'679'788'800, error_))
        << error_;
  }
  std::string complaint() {
    error_.clear();
    EXPECT_FALSE(is_commissioned(config_, error_));
    return error_;
  }

  TemporaryFolder folder_;
  EdgeConfig config_;
  std::string error_;
};

TEST_F(CommissionFile, AnotherAddressIsAnotherBattery) {
  config_.battery.link.host = "192.168.1.20";
  EXPECT_THAT(complaint(), Names("commissioned.toml:6 battery \"127.0.0.1:502 unit 1\""));
  EXPECT_THAT(error_, Names("bess-edge commission --config --yes"));
}

TEST_F(CommissionFile, AnotherVariantOrMapMustBeCheckedAgain) {
  config_.battery.map.variant = "five_writes";
  EXPECT_THAT(complaint(), Names("variant five_writes"));
  config_.battery.map.variant = "block";
  config_.battery.map.name = "other";
  EXPECT_THAT(complaint(), Names("map \"simulator\""));
}

TEST_F(CommissionFile, AnotherUnitOfAGroupMustBeCheckedAgain) {
  config_.battery.map.unit_groups.push_back({.name = "vebus", .unit = 228});
  ASSERT_TRUE(write_commission_file(config_, {}, 1'679'788'800, error_)) << error_;
  EXPECT_TRUE(is_commissioned(config_, error_)) << error_;
  config_.battery.map.unit_groups[0].unit = 246;
  EXPECT_THAT(complaint(), Names("battery vebus 228"));
}

TEST_F(CommissionFile, AnEditedIncludedMapMustBeCheckedAgain) {
  folder_.write("base.toml", "# version 1\n");
  folder_.write("map.toml", "include = \"base.toml\"\n");
  ASSERT_TRUE(write_commission_file(config_, {}, 1'679'788'800, error_)) << error_;
  EXPECT_TRUE(is_commissioned(config_, error_)) << error_;
  folder_.write("base.toml", "# version 2\n");
  EXPECT_THAT(complaint(), Names("map_crc32"));
}

TEST_F(CommissionFile, KeepsWhatWasMeasuredAndStillReadsOlderFiles) {
  CommissionResult result{.verdict = CommissionVerdict::kPassed};
  result.charge = {
      .is_tested = true,
      .measured_power_w = 493,
      .speed = {.dynamics = {.dead_time_s = 1.2, .time_constant_s = 3.1, .ramp_s_per_w = 0.025}}};
  result.meter = MeterVerdict::kFollows;
  result.meter_percent = 98;
  ASSERT_TRUE(write_commission_file(config_, result, 1'679'788'800, error_)) << error_;
  EXPECT_TRUE(is_commissioned(config_, error_)) << error_;
  const std::string text = text_of_file(folder_.file("state/commissioned.toml"));
  for (const char* const line :
       {"charge_measured_w = 493\n", "charge_lag_ms = 1200\n", "charge_time_constant_ms = 3100\n",
        "charge_ramp_w_per_s = 40\n", "meter_percent = 98\n"}) {
    EXPECT_THAT(text, ::testing::HasSubstr(line));
  }
  EXPECT_EQ(text.find("discharge"), std::string::npos);
  folder_.write("state/commissioned.toml", text.substr(0, text.find("charge_measured_w")));
  EXPECT_TRUE(is_commissioned(config_, error_)) << error_;
}

/// In three places, one of them in memory.
class CommissionCopies : public CommissionFile {
 protected:
  CommissionCopies() {
    config_.state.run_folder.assign(folder_.file("run"));
    EXPECT_TRUE(write_commission_file(config_, {}, 1'679'788'800, error_)) << error_;
    text_ = text_of_file(folder_.file("state/commissioned.toml"));
  }
  void expect_all_whole() {
    for (const char* place : kPlaces) EXPECT_EQ(text_of_file(folder_.file(place)), text_) << place;
    EXPECT_THAT(commission_file_losses(config_), ::testing::IsEmpty());
    EXPECT_THAT(repair_commission_file(config_), ::testing::IsEmpty());
  }

  static constexpr const char* kPlaces[] = {"state/commissioned.toml", "state/commissioned.copy",
                                            "run/commissioned.toml"};
  std::string text_;
};

TEST_F(CommissionCopies, AnyFlippedByteOfAnyCopyIsReportedAndRepaired) {
  expect_all_whole();
  for (const char* place : kPlaces) {
    for (std::size_t i = 0; i < text_.size(); i += 7) {
      std::string flipped = text_;
      flipped[i] = static_cast<char>(flipped[i] ^ (1 << i % 8));
      folder_.write(place, flipped);
      ASSERT_TRUE(is_commissioned(config_, error_)) << error_;
      ASSERT_THAT(commission_file_losses(config_),
                  ::testing::ElementsAre(Names(folder_.file(place))))
          << i;
      ASSERT_EQ(text_of_file(folder_.file(place)), flipped) << "a check writes nothing";
      ASSERT_THAT(repair_commission_file(config_),
                  ::testing::ElementsAre(Names(folder_.file(place))))
          << i;
      ASSERT_EQ(text_of_file(folder_.file(place)), text_) << i;
    }
  }
  expect_all_whole();
}

TEST_F(CommissionCopies, WhatIsCutEmptyGoneOrNoFileIsTakenFromTheOthers) {
  namespace fs = std::filesystem;
  for (const char* place : kPlaces) {
    const std::string path = folder_.file(place);
    for (const std::size_t size : {text_.size() - 1, text_.size() / 2, std::size_t{0}}) {
      fs::resize_file(path, size);
      ASSERT_TRUE(is_commissioned(config_, error_)) << error_;
      EXPECT_EQ(repair_commission_file(config_).size(), 1U);
      expect_all_whole();
    }
    fs::remove(path);
    ASSERT_TRUE(is_commissioned(config_, error_)) << error_;
    const bool is_in_memory = std::string(place).starts_with("run/");
    EXPECT_EQ(commission_file_losses(config_).size(), is_in_memory ? 0U : 1U);
    EXPECT_EQ(repair_commission_file(config_).size(), is_in_memory ? 0U : 1U)
        << "a boot is no loss";
    expect_all_whole();
    fs::remove(path);
    fs::create_directory(path);
    ASSERT_TRUE(is_commissioned(config_, error_)) << error_;
    EXPECT_THAT(repair_commission_file(config_), ::testing::ElementsAre(Names(path)));
    fs::remove(path);
    folder_.write(place, text_);
  }
}

TEST_F(CommissionCopies, AllOfThemBrokenIsNoProofAndSaysSo) {
  std::string changed = text_;
  changed[changed.find("2023-03-26")] = '3';
  for (const std::string& broken : {std::string(3, '\0'), changed}) {
    for (const char* place : kPlaces) folder_.write(place, broken);
    EXPECT_THAT(complaint(), Names("commissioned.toml bess-edge commission --config --yes"));
    EXPECT_THAT(repair_commission_file(config_), ::testing::IsEmpty());
  }
}

TEST_F(CommissionCopies, WhatIsHiddenFromThisUserIsNoDyingDisk) {
  for (const char* place : kPlaces) {
    std::filesystem::permissions(folder_.file(place), std::filesystem::perms::none);
  }
  const AsNobody reader;
  EXPECT_THAT(complaint(),
              ::testing::AllOf(Names("commissioned.toml sudo"), ::testing::Not(Names("[state]"))));
}

/// An earlier version kept it once, without a checksum: no loss.
TEST_F(CommissionCopies, AnOlderProgramsFileIsTakenOver) {
  for (const char* place : kPlaces) std::filesystem::remove(folder_.file(place));
  folder_.write(kPlaces[0], text_.substr(0, text_.rfind("# crc32=")));
  ASSERT_TRUE(is_commissioned(config_, error_)) << error_;
  EXPECT_THAT(repair_commission_file(config_), ::testing::IsEmpty());
  expect_all_whole();
}

/// An older file of another battery: readable and unreadable copies must not be mixed.
TEST_F(CommissionCopies, ANewCheckLeavesNoCopyOfThePreviousOne) {
  std::filesystem::remove(folder_.file(kPlaces[1]));
  std::filesystem::create_directory(folder_.file(kPlaces[1]));
  config_.battery.link.host = "192.168.1.20";
  ASSERT_TRUE(write_commission_file(config_, {}, 1'679'788'800, error_)) << error_;
  std::filesystem::remove(folder_.file(kPlaces[0]));
  EXPECT_TRUE(is_commissioned(config_, error_)) << error_;
  config_.battery.link.host = "127.0.0.1";
  EXPECT_THAT(complaint(), Names("battery \"192.168.1.20"));
}

TEST_F(CommissionFile, AFolderThatCannotBeWrittenIsNamed) {
  config_.state.folder.assign("/proc/bess");
  EXPECT_FALSE(write_commission_file(config_, {}, 0, error_));
  EXPECT_THAT(error_, Names("/proc/bess/commissioned.toml"));
}

}  // namespace
}  // namespace bess
