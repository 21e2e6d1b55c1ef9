// What `status`, `history` and the self-test read of upgrades and of the disk.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "edge/log/text_checksum.h"
#include "edge/storage/storage_health.h"
#include "edge/update/trial_state.h"
#include "tests/support/as_nobody.h"
#include "tests/support/fake_card.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

std::string folder_of(const TemporaryFolder& folder) { return folder.file(""); }

TEST(UpdateState, WithoutAPackageThereIsNothingToTell) {
  const TemporaryFolder folder;
  EXPECT_EQ(update_note(read_trial_state(folder_of(folder)).state), "");
  EXPECT_THAT(read_update_history(folder_of(folder)).events, IsEmpty());
  EXPECT_THAT(read_update_history(folder_of(folder)).trouble, HasSubstr("no history here"));
}

TEST(UpdateState, ATrialTellsItsCyclesAndItsWayBack) {
  const TemporaryFolder folder;
  static_cast<void>(
      folder.write("state",
                   "phase=trying\nversion=2.0\nprevious=1.0\nsince_utc=2026-11-22T06:00:00Z\n"
                   "good=7\nneeded=15\n"));
  EXPECT_EQ(update_note(read_trial_state(folder_of(folder)).state),
            "2.0 on trial since 2026-11-22T06:00:00Z, 7 of 15 good cycles; else back to 1.0");
}

TEST(UpdateState, ARollBackTellsWhatAndWhyAlsoWithAnEqualsSign) {
  const TemporaryFolder folder;
  static_cast<void>(folder.write(
      "state", "phase=rolled_back\nversion=1.0\nrefused=2.0\nreason=map x: unit = 7\n"));
  EXPECT_EQ(update_note(read_trial_state(folder_of(folder)).state),
            "1.0; 2.0 was rolled back: map x: unit = 7");
}

TEST(UpdateState, WhatDpkgBelievesIsToldWhereItDiffers) {
  TrialState state;
  state.phase = TrialPhase::kRolledBack;
  state.version = "1.0";
  state.refused = "2.0";
  state.reason = "it hangs";
  state.delivered = "ii 2.0";
  EXPECT_EQ(update_note(state),
            "1.0; 2.0 was rolled back: it hangs (dpkg still has it: ii 2.0, it does not run)");
  state.phase = TrialPhase::kConfirmed;
  EXPECT_EQ(update_note(state), "1.0 confirmed");
  state.delivered = "iF 1.0";
  EXPECT_EQ(update_note(state),
            "1.0 confirmed; dpkg has it half installed (iF 1.0): dpkg --configure -a");
}

TEST(UpdateState, WhatDpkgHalfDidIsTroubleWithTheMendThatEndsIt) {
  EXPECT_EQ(dpkg_mend("ii 2.0"), "");
  EXPECT_EQ(dpkg_mend(""), "");
  EXPECT_EQ(dpkg_mend("rc 2.0"), "");
  EXPECT_EQ(dpkg_mend("iU 2.0"), "dpkg --configure -a");
  EXPECT_EQ(dpkg_mend("iF 2.0"), "dpkg --configure -a");
  EXPECT_EQ(dpkg_mend("iW 2.0"), "dpkg --configure -a");
  // dpkg --configure answers these with "very bad inconsistent state".
  EXPECT_EQ(dpkg_mend("iHR2.0"), "apt install --reinstall bess-edge");
  EXPECT_EQ(dpkg_mend("iUR2.0"), "apt install --reinstall bess-edge");
  EXPECT_EQ(dpkg_mend("iH 2.0"), "apt install --reinstall bess-edge");
  TrialState state;
  state.version = "1.0";
  state.delivered = "iHR1.0";
  state.phase = TrialPhase::kConfirmed;
  EXPECT_EQ(update_trouble(state),
            "1.0 confirmed; dpkg has it half installed (iHR1.0): apt install --reinstall "
            "bess-edge");
  state.delivered = "ii 1.0";
  EXPECT_EQ(update_trouble(state), "");
  state.phase = TrialPhase::kRolledBack;
  state.refused = "2.0";
  state.reason = "dpkg did not end";
  state.delivered = "iF 2.0";
  EXPECT_EQ(update_trouble(state),
            "1.0; 2.0 was rolled back: dpkg did not end; dpkg has it half installed (iF 2.0): "
            "dpkg --configure -a");
}

TEST(UpdateState, AllThatIsKeptIsReadAsItWasWritten) {
  const TemporaryFolder folder;
  TrialState state;
  state.phase = TrialPhase::kComparing;
  state.version = "2.0";
  state.previous = "1.0";
  state.refused_all = "0.8 0.9";
  state.window = "1101";
  state.shared = "price,link";
  state.bad_cause = "link";
  state.mark = "2026-11-22T06:00:00Z 7";
  state.restarts = 3;
  state.needed_cycles = 17;
  state.is_fresh = true;
  std::string error;
  ASSERT_TRUE(write_trial_state(folder_of(folder), state, error)) << error;
  const ReadTrialState read = read_trial_state(folder_of(folder));
  EXPECT_EQ(read.damage, "");
  EXPECT_EQ(trial_phase_name(read.state.phase), "comparing");
  EXPECT_EQ(read.state.refused_all, state.refused_all);
  EXPECT_EQ(read.state.window, state.window);
  EXPECT_EQ(read.state.shared, state.shared);
  EXPECT_EQ(read.state.bad_cause, state.bad_cause);
  EXPECT_EQ(read.state.mark, state.mark);
  EXPECT_EQ(read.state.restarts, 3);
  EXPECT_EQ(read.state.needed_cycles, 17);
  EXPECT_TRUE(read.state.is_fresh);
  EXPECT_FALSE(read.state.is_handed_over);
}

TEST(UpdateState, OnlyWhatEndedBadlyIsTroubleForHealth) {
  const TemporaryFolder folder;
  const auto trouble_of = [&](const std::string& phase) {
    static_cast<void>(
        folder.write("state", "phase=" + phase + "\nversion=1.0\nrefused=2.0\nreason=it hangs\n"));
    return update_trouble(read_trial_state(folder_of(folder)).state);
  };
  EXPECT_EQ(trouble_of("rolled_back"), "1.0; 2.0 was rolled back: it hangs");
  EXPECT_EQ(trouble_of("going_back"), "2.0 is being rolled back: it hangs");
  EXPECT_EQ(trouble_of("failed"), "1.0 did not confirm: it hangs");
  for (const char* const phase : {"upgrading", "trying", "confirmed", ""}) {
    EXPECT_EQ(trouble_of(phase), "") << phase;
  }
}

/// As it is written: with its checksum, and a copy.
class UpdateStateCopies : public ::testing::Test {
 protected:
  UpdateStateCopies() {
    text_ = "phase=rolled_back\nversion=1.0\nrefused=2.0\nreason=it hangs\nneeded=15\n";
    older_ = text_;
    text_ += checksum_end(text_, kCommentChecksum).view();
    put(text_, text_);
  }
  void put(const std::string& state, const std::string& copy) {
    static_cast<void>(folder_.write("state", state));
    static_cast<void>(folder_.write("state.copy", copy));
  }
  [[nodiscard]] std::string trouble() const {
    return update_trouble(read_trial_state(folder_of(folder_)).state);
  }

  static constexpr const char* kTrouble = "1.0; 2.0 was rolled back: it hangs";
  const TemporaryFolder folder_;
  std::string text_;
  std::string older_;  ///< the same, of a program without checksums
};

TEST_F(UpdateStateCopies, WhatIsDamagedIsTakenFromTheCopy) {
  for (std::size_t i = 0; i < text_.size(); ++i) {
    std::string flipped = text_;
    flipped[i] = static_cast<char>(flipped[i] ^ (1 << i % 8));
    put(flipped, text_);
    ASSERT_EQ(trouble(), kTrouble) << i;
    put(text_, flipped);
    ASSERT_EQ(trouble(), kTrouble) << i;
    put(text_.substr(0, i), text_);
    ASSERT_EQ(trouble(), kTrouble) << i;
  }
}

TEST_F(UpdateStateCopies, BothDamagedIsToldAndNothingIsBelieved) {
  put(std::string(200, '\0'), text_.substr(0, 40));
  EXPECT_THAT(trouble(), AllOf(HasSubstr("the state of the upgrades is lost: "),
                               HasSubstr("state and its copy are damaged")));
}

TEST_F(UpdateStateCopies, AnOlderProgramsWordIsNewerThanTheCopy) {
  std::string confirmed = older_;
  confirmed.replace(0, confirmed.find('\n'), "phase=confirmed");
  put(confirmed, text_);
  EXPECT_EQ(trouble(), "");
}

TEST(UpdateHistory, OldestFirstAndNotWhatAPowerCutTore) {
  const TemporaryFolder folder;
  static_cast<void>(
      folder.write("history",
                   "2026-11-22T06:00:00Z\ttrying\t2.0\t45d2cbe3\t72c9\t\n"
                   "2026-11-22T06:09:00Z\trolled_back\t2.0\t45d2cbe3\t72c9\tthe unit failed\n"
                   "2026-11-22T07:00:00Z\ttrying\t3.0\t45d2cbe3\t72c9\thal"));
  const auto history = read_update_history(folder_of(folder));
  const auto& events = history.events;
  EXPECT_EQ(history.trouble, "");
  EXPECT_EQ(history.damaged_lines, 1);
  ASSERT_THAT(events, SizeIs(2));
  EXPECT_EQ(events[0].event, "trying");
  EXPECT_EQ(events[0].reason, "");
  EXPECT_EQ(events[1].version, "2.0");
  EXPECT_EQ(events[1].student, "45d2cbe3");
  EXPECT_EQ(events[1].header_sha256, "72c9");
  EXPECT_EQ(events[1].reason, "the unit failed");
}

TEST(UpdateHistory, WhatIsNoLineIsCountedAndNotShown) {
  const TemporaryFolder folder;
  const std::string line = "2026-11-22T06:00:00Z\ttrying\t2.0\t45d2cbe3\t72c9\t\n";
  for (const std::string& damaged :
       {std::string(40, '\0') + "\n", std::string("2O26-11-22T06:00:00Z") + line.substr(20),
        line.substr(0, 22) + "p" + line.substr(23), line.substr(0, 9) + "\n",
        line.substr(0, 32) + "G" + line.substr(33)}) {
    static_cast<void>(folder.write("history", line + damaged + line));
    const UpdateHistory history = read_update_history(folder_of(folder));
    EXPECT_EQ(history.damaged_lines, 1) << damaged;
    EXPECT_THAT(history.events, SizeIs(2)) << damaged;
  }
}

TEST(UpdateHistory, WhatCannotBeReadSaysWhy) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.file("history"));
  EXPECT_THAT(read_update_history(folder_of(folder)).trouble,
              HasSubstr("history cannot be read: Is a directory"));
}

/// Written by a root whose files are for root alone; `status` is asked by anybody.
TEST_F(UpdateStateCopies, WhatIsHiddenFromThisUserIsToldWithTheMend) {
  static_cast<void>(folder_.write("history", "x"));
  for (const char* name : {"state", "state.copy", "history"}) {
    std::filesystem::permissions(folder_.file(name), std::filesystem::perms::none);
  }
  const AsNobody reader;
  EXPECT_THAT(trouble(), AllOf(HasSubstr("state cannot be read by this user"),
                               HasSubstr("sudo chmod a+r"), Not(HasSubstr("damaged"))));
  EXPECT_THAT(read_update_history(folder_of(folder_)).trouble, HasSubstr("sudo chmod a+r"));
}

TEST(StorageHealth, WearIsTheWorseOfTheTwoKindsOfCells) {
  EXPECT_EQ(used_life_percent("0x01 0x03\n"), 30);
  EXPECT_EQ(used_life_percent("0x0a 0x00\n"), 100);
  EXPECT_EQ(used_life_percent("0x0b 0x01\n"), 110);
  for (const char* untold : {"0x00 0x00\n", "unknown", "", "0x", "0x0c 0x01\n"}) {
    EXPECT_EQ(used_life_percent(untold), 0) << untold;
  }
  EXPECT_EQ(spare_level("0x01\n"), 1);
  EXPECT_EQ(spare_level("0x03\n"), 3);
  for (const char* untold : {"0x00\n", "0x04\n", "3\n", "", "0x"}) {
    EXPECT_EQ(spare_level(untold), 0) << untold;
  }
}

TEST(StorageHealth, WhatNoDeviceTellsIsNotMadeUp) {
  for (const char* folder : {"/no/such/folder", "/proc"}) {
    const CardWear wear = card_wear_of(folder);
    EXPECT_EQ(wear.used_life_percent, 0) << folder;
    EXPECT_EQ(wear.spare_level, 0) << folder;
    EXPECT_LT(wear.file_system_errors, 0) << folder;
  }
}

TEST(StorageHealth, AnEmmcAndItsFileSystemAreReadThroughThePartition) {
  const TemporaryFolder root;
  const TemporaryFolder state;
  setenv("BESS_ROOT", root.file("").c_str(), 1);
  write_card(root, state.file(""),
             {.life_time = "0x02 0x0a\n", .pre_eol_info = "0x02\n", .errors = "7\n"});
  const CardWear wear = card_wear_of(state.file(""));
  unsetenv("BESS_ROOT");
  EXPECT_EQ(wear.used_life_percent, 100);
  EXPECT_EQ(wear.spare_level, 2);
  EXPECT_EQ(wear.file_system_errors, 7);
}

TEST(StorageHealth, ATrialWriteLeavesNothing) {
  const TemporaryFolder folder;
  const StorageHealth health = look_at_storage(folder.file("state"));
  EXPECT_TRUE(health.is_writable) << health.error;
  EXPECT_GT(health.free_mb, 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder.file("state")));
}

TEST(StorageHealth, AFolderThatCannotBeSaysWhy) {
  const TemporaryFolder folder;
  static_cast<void>(folder.write("file", ""));
  const StorageHealth health = look_at_storage(folder.file("file/state"));
  EXPECT_FALSE(health.is_writable);
  EXPECT_EQ(health.error, "Not a directory");
}

}  // namespace
}  // namespace bess
