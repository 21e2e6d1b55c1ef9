// Hold from the command to the mailbox: the file's text, invalid texts, and the watching thread.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <memory>

#include "edge/app/program/hold_watch.h"
#include "edge/app/storage/operator_files.h"
#include "edge/records/log/atomic_file.h"
#include "shared/scaled_clock.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

constexpr Hold kHold{.power_w = -2'000, .until_utc_s = 1'679'875'320};

std::string line_of(const Hold& hold) { return std::string(format_hold(hold).view()); }

TEST(HoldFile, IsOneLineThatReadsBack) {
  EXPECT_EQ(line_of(kHold), "bess-hold 1 power_w=-000002000 until=2023-03-27T00:02:00Z crc32=" +
                                line_of(kHold).substr(64, 8) + "\n");
  for (const Hold& hold :
       {kHold, Hold{.power_w = 0, .until_utc_s = 1}, Hold{.power_w = 100'000'000, .until_utc_s = 2},
        Hold{.power_w = -100'000'000, .until_utc_s = UINT32_MAX - 1}}) {
    EXPECT_EQ(line_of(hold).size(), kHoldFileBytes);
    EXPECT_EQ(parse_hold(line_of(hold)), hold);
  }
}

TEST(HoldFile, AnythingElseIsUnreadable) {
  const std::string good = line_of(kHold);
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const char c : {'\0', '0', '1', '-', 'x', '\n'}) {
      std::string bad = good;
      if (bad[i] == c) continue;
      bad[i] = c;
      EXPECT_TRUE(parse_hold(bad).unreadable) << bad;
    }
    EXPECT_TRUE(parse_hold(good.substr(0, i)).unreadable);
  }
  EXPECT_TRUE(parse_hold(good + "\n").unreadable);
}

TEST(HoldFile, NoFileIsNoHoldAndWhatBlocksOrLeadsAwayIsUnreadable) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_hold(folder.file("hold").c_str()), Hold{});
  EXPECT_EQ(read_hold(folder.write("good", line_of(kHold)).c_str()), kHold);
  ASSERT_EQ(mkfifo(folder.file("pipe").c_str(), 0600), 0);
  EXPECT_TRUE(read_hold(folder.file("pipe").c_str()).unreadable);
  std::filesystem::create_symlink("good", folder.file("link"));
  EXPECT_TRUE(read_hold(folder.file("link").c_str()).unreadable);
  EXPECT_TRUE(read_hold(folder.file("").c_str()).unreadable);  // the folder itself
  EXPECT_TRUE(read_hold(folder.write("empty", "").c_str()).unreadable);
  EXPECT_TRUE(read_hold(folder.write("big", std::string(1'000'000, 'x')).c_str()).unreadable);
}

/// Waits for the other thread's finding; false after 30 s.
bool is_published(const HoldWatch& watch, const Hold& hold) {
  for (int ms = 0; ms < 30'000; ++ms) {
    if (watch.latest_hold().latest() == hold) return true;
    sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + kNanosecondsPerSecond / 1'000);
  }
  return false;
}

TEST(HoldWatch, KnowsTheFileImmediatelyAndFollowsIt) {
  const TemporaryFolder folder;
  const std::string path = folder.write("hold", line_of(kHold));
  const auto watch = std::make_unique<HoldWatch>();
  watch->start({.state = path.c_str(), .run = ""}, {}, 900);
  EXPECT_EQ(watch->latest_hold().latest(), kHold);  // before the thread has looked
  const Hold other{.power_w = 3, .until_utc_s = 4};
  ASSERT_TRUE(replace_file(path.c_str(), line_of(other)));
  EXPECT_TRUE(is_published(*watch, other));
  ASSERT_TRUE(replace_file(path.c_str(), "nonsense"));
  EXPECT_TRUE(is_published(*watch, {.unreadable = true}));
  std::filesystem::remove(path);
  EXPECT_TRUE(is_published(*watch, Hold{}));
}

/// Two copies, as after a disk has refused some writes.
class TwoHolds : public ::testing::Test {
 protected:
  TwoHolds() : paths_{.state = folder_.file("state").c_str(), .run = folder_.file("run").c_str()} {}
  /// Since `minute` of the real clock.
  static void put(const FixedText<639>& path, const std::string& text, int minute) {
    ASSERT_TRUE(replace_file(path.c_str(), text));
    std::filesystem::last_write_time(
        path.c_str(), std::filesystem::file_time_type() + std::chrono::minutes(minute));
  }
  [[nodiscard]] HoldReading reading() const { return read_newest_hold(paths_); }

  const TemporaryFolder folder_;
  const StateFilePaths paths_;
  const Hold other_{.power_w = 3, .until_utc_s = 4};
};

TEST_F(TwoHolds, TheNewerHoldCounts) {
  EXPECT_EQ(reading(), HoldReading{});
  put(paths_.state, line_of(kHold), 1);
  EXPECT_EQ(reading(), HoldReading{.hold = kHold}) << "memory is empty after a boot";
  put(paths_.run, line_of(other_), 2);
  EXPECT_EQ(reading(), HoldReading{.hold = other_});
  put(paths_.state, line_of(kHold), 3);
  EXPECT_EQ(reading(), HoldReading{.hold = kHold});
  std::filesystem::remove(paths_.state.c_str());
  EXPECT_EQ(reading(), HoldReading{.hold = other_}) << "another disk, without state";
  EXPECT_EQ(read_newest_hold({.state = paths_.state, .run = ""}), HoldReading{});
}

TEST_F(TwoHolds, WhatCannotBeUnderstoodLeavesTheOtherAndIsNamed) {
  put(paths_.state, line_of(kHold), 1);
  put(paths_.run, line_of(kHold), 2);
  put(paths_.state, std::string(kHoldFileBytes, '\0'), 3);
  EXPECT_EQ(reading(), (HoldReading{.hold = kHold, .state_is_lost = true}));
  put(paths_.state, line_of(kHold), 3);
  std::filesystem::remove(paths_.run.c_str());
  std::filesystem::create_directory(paths_.run.c_str());
  EXPECT_EQ(reading(), (HoldReading{.hold = kHold, .run_is_lost = true}));
  put(paths_.state, "", 4);
  EXPECT_TRUE(reading().hold.unreadable);
}

TEST_F(TwoHolds, TheWatchNamesALossOnce) {
  put(paths_.state, line_of(kHold), 1);
  put(paths_.run, line_of(kHold), 2);
  const auto watch = std::make_unique<HoldWatch>();
  ::testing::internal::CaptureStderr();
  watch->start(paths_, {}, 900);
  put(paths_.state, "nonsense", 3);
  put(paths_.run, line_of(other_), 4);
  EXPECT_TRUE(is_published(*watch, other_));  // a look at both
  put(paths_.run, line_of(kHold), 5);
  EXPECT_TRUE(is_published(*watch, kHold));  // the look before this one has ended
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, Names("hold " + folder_.file("state") + " " + folder_.file("run")));
  EXPECT_EQ(std::ranges::count(said, '\n'), 1) << said;
}

}  // namespace
}  // namespace bess
