// Failing disk under the real programs: full, read-only, without answer, gone, with flipped bytes.
// Status, metrics and alarms never contradict the controller's last decision, and a trip stays
// until a person clears it.
#include <gmock/gmock.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "tests/support/edge_answer.h"
#include "tests/support/journal_fields.h"
#include "tests/support/tokens.h"
#include "tests/support/utc_of.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::int32_t kScale = 300;
constexpr int kCyclesToTrip = 12;  ///< at most, including the change of the battery

/// As in the metrics.
std::string utc_number(const std::string& utc) { return std::to_string(utc_of(utc)); }

/// As a boot does; bess-prices may just be leaving it.
void lose_folder(const std::string& folder) {
  std::error_code error;
  do fs::remove_all(folder, error);
  while (error || fs::exists(folder));
}

/// The state folder as a separate disk, and its faults.
class StateDisk {
 public:
  explicit StateDisk(const SimulatedSite& site)
      : folder_(site.folder.file("state")), control_(site.folder.file("dying_disk")) {
    fs::create_directory(folder_);
    is_mounted_ =
        has_own_mounts() && mount("bess_test", folder_.c_str(), "tmpfs", 0, "size=30m") == 0;
    setenv("LD_PRELOAD", BESS_DYING_DISK, 1);
    setenv("BESS_DYING_DISK", control_.c_str(), 1);
  }
  StateDisk(const StateDisk&) = delete;
  StateDisk& operator=(const StateDisk&) = delete;
  ~StateDisk() {
    unsetenv("LD_PRELOAD");
    unsetenv("BESS_DYING_DISK");
    if (is_mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  [[nodiscard]] bool is_mounted() const { return is_mounted_; }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_ + "/" + name; }

  /// By mount(8); only while nothing is open for writing.
  void remount_read_only() const {
    EXPECT_EQ(mount(nullptr, folder_.c_str(), nullptr, MS_REMOUNT | MS_RDONLY, nullptr), 0);
  }

  void fill() const {
    std::ofstream filler(file("filler"), std::ios::app);
    while (filler << std::string(1024, 'x') << std::flush) continue;
  }
  void free_again() const { fs::remove(file("filler")); }
  /// As the kernel does after an error, under whatever has files open.
  void go_read_only() const { std::ofstream(control_) << "EROFS " << folder_; }
  void go_silent() const { std::ofstream(control_) << "EIO " << folder_; }
  void come_back() const { fs::remove(control_); }
  /// The mount disappears under any open files; the folder below it stays, empty.
  void unmount() {
    EXPECT_EQ(umount2(folder_.c_str(), MNT_DETACH), 0);
    is_mounted_ = false;
  }
  /// Another folder is visible there from now on, like a disk that is mounted late.
  void mount_late(const std::string& other) {
    EXPECT_EQ(mount(other.c_str(), folder_.c_str(), nullptr, MS_BIND, nullptr), 0);
    is_mounted_ = true;
  }
  [[nodiscard]] const std::string& folder() const { return folder_; }
  void go_away() const { fs::remove(file("decisions.ring")); }
  void flip(const std::string& name, std::uintmax_t from, std::uintmax_t to) const {
    std::fstream bytes(file(name), std::ios::in | std::ios::out | std::ios::binary);
    std::string text(to - from, '\0');
    bytes.seekg(static_cast<std::streamoff>(from));
    bytes.read(text.data(), static_cast<std::streamsize>(text.size()));
    for (char& byte : text) byte = static_cast<char>(byte ^ 0x5a);
    bytes.seekp(static_cast<std::streamoff>(from));
    bytes.write(text.data(), static_cast<std::streamsize>(text.size()));
  }

 private:
  /// Mounts made here end with this process, on any exit.
  static bool has_own_mounts() {
    static const bool is_done =
        unshare(CLONE_NEWNS) == 0 && mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
    return is_done;
  }

  std::string folder_;
  std::string control_;
  bool is_mounted_ = false;
};

class DyingDisk : public SiteTest {
 protected:
  DyingDisk() : SiteTest(kScale), disk_(site_) {}

  void SetUp() override {
#ifdef BESS_SANITIZED
    GTEST_SKIP() << "a sanitizer's runtime must come before LD_PRELOAD";
#endif
    if (!disk_.is_mounted()) GTEST_SKIP() << "needs root, to mount a small disk";
    site_.start_battery();
    site_.start_market({}, SimulatedSite::flat_prices(6'000, 1'700));
  }

  void commission(bool has_run_folder, const std::string& keys = "") {
    const std::string run = "run_folder = \"" + site_.folder.file("run") + "\"\n";
    config_ = site_.commission({.guard_keys = "price_age_s_max = 1800\n",  // stopped during queries
                                .state_keys = (has_run_folder ? run : "") + keys});
  }
  void start() {
    controller_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{edge_program(), "--config", config_});
  }
  void await_running() { ASSERT_NE(await_cycle("mode", "running", 8), "") << said_; }
  void start_and_run(bool has_run_folder) {
    commission(has_run_folder);
    start();
    await_running();
  }
  /// The first control cycle line with this word, within a number of lines; empty if there is none.
  std::string await_cycle(const std::string& name, const std::string& word, int cycles_max) {
    for (int cycle = 0; cycle < cycles_max;) {
      const std::string line = controller_->read_line();
      if (line.empty()) return "";
      said_ += line + "\n";
      if (!line.starts_with("utc=")) continue;
      ++cycle;
      if (journal_fields(line)[name] == word) return line;
    }
    return "";
  }
  void await_cycles(int count, const std::string& name, const std::string& word, int cycles_max) {
    for (int i = 0; i < count; ++i) {
      ASSERT_NE(await_cycle(name, word, cycles_max), "") << said_;
    }
  }
  /// Another battery at the same address, with reversed power.
  void swap_battery(bool is_wrong) {
    const int port = site_.battery_port;
    site_.battery.reset();
    site_.start_battery(
        is_wrong ? std::vector<std::string>{"--fault", "wrong-sign", "--fault-every", "1"}
                 : std::vector<std::string>{},
        port);
  }
  void trip() {
    swap_battery(true);
    ASSERT_NE(await_cycle("reason", "wrong_direction", kCyclesToTrip), "") << said_;
  }
  /// Trips and ends; then the right battery is back.
  void end_tripped() {
    trip();
    await_cycle("reason", "wrong_direction", 6);
    end_run();
    swap_battery(false);
  }
  void end_run() {
    EXPECT_EQ(SimulatedSite::stop(*controller_), 0);
    said_ += controller_->read_all();
  }

  struct Answers {
    CsvRow decided;  ///< the newest control cycle, by the CSV on another disk
    std::string status;
    std::string json;
    std::string metrics;
  };
  /// Queries all programs while the controller is stopped.
  Answers ask_all() {
    controller_->signal(SIGSTOP);
    Answers answers;
    answers.decided = edge_log().back();
    answers.status = ask({"status"}).text;
    answers.json = ask({"status", "--json", "--no-lock"}).text;
    answers.metrics = ask({"status", "--prometheus"}).text;
    controller_->signal(SIGCONT);
    return answers;
  }

  /// All reports equal the controller's last decision. Repeated if it was stopped between decision
  /// and report.
  void expect_all_agree(bool may_be_unknown) {
    Answers answers = ask_all();
    for (int i = 0; i < 20; ++i) {
      const std::string& utc = answers.decided.at("utc");
      const bool is_reported = answers.status.find(local_text_of(utc)) != std::string::npos &&
                               answers.json.find(utc) != std::string::npos &&
                               answers.metrics.find(utc_number(utc)) != std::string::npos;
      if (is_reported || may_be_unknown) break;
      usleep(40'000);
      answers = ask_all();
    }
    const std::string& utc = answers.decided.at("utc");
    const std::string& reason = answers.decided.at("reason");
    const bool is_tripped = answers.decided.at("trip") != "none";
    const Json json = Json::parse(answers.json);
    const bool is_unknown = json.value()["unknown"].exists();
    EXPECT_TRUE(may_be_unknown || !is_unknown) << answers.json;
    EXPECT_EQ(json.value()["last"].exists(), !is_unknown) << answers.json;
    EXPECT_STRNE(json.value()["health"].text_or(""), "not running") << utc;
    for (const std::string& text : {answers.status, answers.json}) {
      if (is_unknown || is_tripped) {
        EXPECT_THAT(text, Names("CRITICAL degraded"));
      }
      if (is_unknown) continue;
      EXPECT_THAT(text, AllOf(::testing::AnyOf(HasSubstr(utc), HasSubstr(local_text_of(utc))),
                              HasSubstr(reason)));
    }
    if (may_be_unknown) return;
    EXPECT_THAT(
        answers.metrics,
        AllOf(
            ContainsRegex(is_tripped ? "bess_tripped[{].*[}] 1\n" : "bess_tripped[{].*[}] 0\n"),
            ContainsRegex("bess_last_cycle_timestamp_seconds[{].*[}] " + utc_number(utc) + "\n")));
  }

  StateDisk disk_;
  std::unique_ptr<ChildProcess> controller_;
  std::string said_;
};

/// The disk fails under a running controller, which then trips.
struct Death {
  const char* name;
  void (*happen)(const StateDisk& disk);
  bool log_lives;  ///< the ring, in its file of fixed size
};
constexpr Death kDeaths[] = {
    {"Full", [](const StateDisk& disk) { disk.fill(); }, true},
    {"ReadOnly", [](const StateDisk& disk) { disk.go_read_only(); }, false},
    {"IoErrors", [](const StateDisk& disk) { disk.go_silent(); }, false},
};

class DyingDiskRun : public DyingDisk, public ::testing::WithParamInterface<Death> {};

TEST_P(DyingDiskRun, WithARunFolderAllSayWhatIsAndTheTripStays) {
  ASSERT_NO_FATAL_FAILURE(start_and_run(true));
  GetParam().happen(disk_);
  ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
  expect_all_agree(false);
  trip();
  ASSERT_NE(await_cycle("reason", "wrong_direction", 6), "") << said_;
  expect_all_agree(false);
  swap_battery(false);
  end_run();

  start();  // on the dead disk
  await_cycles(2, "reason", "wrong_direction", 6);
  expect_all_agree(false);
  const ProgramOutput cleared = ask({"clear", "--yes"});
  EXPECT_EQ(cleared.exit_code, 0) << cleared.text;
  EXPECT_THAT(cleared.text, HasSubstr(site_.folder.file("run"))) << "the only copy";
  await_cycles(2, "mode", "running", 8);
  expect_all_agree(false);
  end_run();

  start();  // a cleared trip stays cleared
  EXPECT_NE(await_cycle("mode", "running", 8), "") << said_;
  disk_.free_again();
  disk_.come_back();
  ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
  expect_all_agree(false);
  end_run();
}

TEST_P(DyingDiskRun, WithoutARunFolderTheyKnowOrSayThatTheyDoNot) {
  ASSERT_NO_FATAL_FAILURE(start_and_run(false));
  GetParam().happen(disk_);
  await_cycle("mode", "running", 8);
  trip();
  for (int cycle = 0; cycle < 5; ++cycle) await_cycle("reason", "wrong_direction", 6);
  expect_all_agree(!GetParam().log_lives);
  end_run();
}

INSTANTIATE_TEST_SUITE_P(All, DyingDiskRun, ::testing::ValuesIn(kDeaths),
                         [](const auto& info) { return std::string(info.param.name); });

/// Disk faults between a tripped run and the next start.
struct Accident {
  const char* name;
  void (*happen)(const StateDisk& disk);
  bool boots;            ///< the run folder is empty again
  const char* expected;  ///< reason of the next run's control cycles
};

constexpr Accident kAccidents[] = {
    {"ReadOnly", [](const StateDisk& disk) { disk.go_read_only(); }, false, "wrong_direction"},
    {"RemountedAfterABoot", [](const StateDisk& disk) { disk.remount_read_only(); }, true,
     "wrong_direction"},
    {"HeaderGone", [](const StateDisk& disk) { disk.flip("decisions.ring", 0, 4'096); }, true,
     "wrong_direction"},
    {"LogGone", [](const StateDisk& disk) { disk.go_away(); }, false, "wrong_direction"},
    {"LogGoneAfterABoot", [](const StateDisk& disk) { disk.go_away(); }, true, "state_lost"},
    {"LogGarbageAfterABoot",
     [](const StateDisk& disk) { disk.flip("decisions.ring", 0, 4'096 + 512 * 64); }, true,
     "state_lost"},
};

class DyingDiskStart : public DyingDisk, public ::testing::WithParamInterface<Accident> {};

TEST_P(DyingDiskStart, ATripIsNotForgotten) {
  ASSERT_NO_FATAL_FAILURE(start_and_run(true));
  end_tripped();
  said_.clear();
  GetParam().happen(disk_);
  if (GetParam().boots) lose_folder(site_.folder.file("run"));

  start();
  EXPECT_NE(await_cycle("reason", GetParam().expected, 6), "") << said_;
  EXPECT_THAT(said_, Not(HasSubstr("mode=running")));
  ASSERT_NE(await_cycle("reason", GetParam().expected, 6), "") << said_;
  expect_all_agree(false);
  const ProgramOutput cleared = ask({"clear", "--yes"});
  EXPECT_EQ(cleared.exit_code, 0) << cleared.text;
  EXPECT_NE(await_cycle("mode", "running", 8), "") << said_;
  end_run();
}

INSTANTIATE_TEST_SUITE_P(All, DyingDiskStart, ::testing::ValuesIn(kAccidents),
                         [](const auto& info) { return std::string(info.param.name); });

/// Operator commands while the disk refuses writes.
class DyingDiskCommands : public DyingDisk {
 protected:
  ProgramOutput hold(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "hold");
    return ask(std::move(arguments));
  }
  void break_disk(bool is_full) { is_full ? disk_.fill() : disk_.go_read_only(); }
  void mend_disk(bool is_full) { is_full ? disk_.free_again() : disk_.come_back(); }
};

TEST_F(DyingDiskCommands, WithoutARunFolderWhatCannotBeWrittenLeavesThePreviousOne) {
  commission(false);
  std::ofstream(config_, std::ios::app) << "[limits]\nfile = \"" << disk_.file("limit") << "\"\n";
  const auto limit = [&](const std::string& power_w) {
    return ask({"limit", "--charge", power_w, "--for", "15m"});
  };
  for (const bool is_full : {true, false}) {
    ASSERT_EQ(hold({"-1000", "--for", "2h"}).exit_code, 0);
    ASSERT_EQ(limit("2000").exit_code, 0);
    const std::string hold_before = text_of_file(disk_.file("hold"));
    const std::string limit_before = text_of_file(disk_.file("limit"));
    ASSERT_FALSE(hold_before.empty() || limit_before.empty());
    break_disk(is_full);
    for (const ProgramOutput& said : {hold({"2000", "--for", "1h"}), limit("1000")}) {
      EXPECT_EQ(said.exit_code, 1) << said.text;
      EXPECT_THAT(said.text, HasSubstr(std::strerror(is_full ? ENOSPC : EROFS)));
    }
    EXPECT_EQ(hold({"--release"}).exit_code, is_full ? 0 : 1) << "a removal needs no room";
    EXPECT_EQ(text_of_file(disk_.file("hold")), is_full ? "" : hold_before);
    EXPECT_EQ(text_of_file(disk_.file("limit")), limit_before);
    mend_disk(is_full);
  }
}

TEST_F(DyingDiskCommands, WithARunFolderTheNewestCommandCountsUntilTheBoot) {
  for (const bool is_full : {true, false}) {
    lose_folder(site_.folder.file("run"));
    ASSERT_NO_FATAL_FAILURE(start_and_run(true));
    ASSERT_EQ(hold({"-1000", "--for", "6h"}).exit_code, 0);
    ASSERT_NE(await_cycle("ordered_power_w", "-1000", 8), "") << said_;
    break_disk(is_full);
    const ProgramOutput other = hold({"-2000", "--for", "6h"});
    EXPECT_EQ(other.exit_code, 0) << other.text;
    EXPECT_THAT(other.text, AllOf(HasSubstr(std::strerror(is_full ? ENOSPC : EROFS)),
                                  HasSubstr(site_.folder.file("run/hold"))));
    EXPECT_NE(await_cycle("ordered_power_w", "-2000", 8), "") << said_;
    const ProgramOutput released = hold({"--release"});
    EXPECT_EQ(released.exit_code, 0) << released.text;
    EXPECT_EQ(released.text.find(site_.folder.file("run/hold")) == std::string::npos, is_full)
        << "what goes needs no room: " << released.text;
    EXPECT_NE(await_cycle("ordered_power_w", "-4000", 8), "") << said_;
    end_run();
    mend_disk(is_full);
    ASSERT_EQ(hold({"--release"}).exit_code, 0);
    for (const char* path : {"state/hold", "run/hold"}) {
      EXPECT_FALSE(fs::exists(site_.folder.file(path))) << path;
    }
    said_.clear();
  }
}

TEST_F(DyingDisk, FullOrReadOnlyFromTheStartItIsNotDriven) {
  for (const Death& death : kDeaths) {
    if (death.name == std::string("IoErrors")) continue;  // not commissioned: nothing can be read
    for (const bool has_run_folder : {true, false}) {
      lose_folder(site_.folder.file("run"));
      commission(has_run_folder);
      death.happen(disk_);
      start();
      await_cycles(2, "reason", "state_lost", 6);
      expect_all_agree(!has_run_folder);
      end_run();
      EXPECT_THAT(said_, Names("bess-edge clear --yes"));
      disk_.free_again();
      disk_.come_back();
      for (const char* name : {"status.json", "decisions.ring", "metrics.prom"}) {
        fs::remove(disk_.file(name));
      }
      said_.clear();
    }
  }
}

/// The folder is suddenly empty: known state is written to it.
TEST_F(DyingDisk, UnmountedDuringARunItContinuesInTheFolderBelow) {
  ASSERT_NO_FATAL_FAILURE(start_and_run(true));
  disk_.unmount();
  await_cycles(2, "mode", "running", 8);
  expect_all_agree(false);
  trip();
  await_cycle("reason", "wrong_direction", 6);
  expect_all_agree(false);
  end_run();
  swap_battery(false);
  said_.clear();
  start();  // with the sign check from memory
  EXPECT_NE(await_cycle("reason", "wrong_direction", 6), "") << said_;
  end_run();
  EXPECT_THAT(said_, AllOf(Names("commissioned.toml"), Not(HasSubstr("mode=running"))));
  lose_folder(site_.folder.file("run"));  // and after a boot
  fs::remove(disk_.file("commissioned.toml"));
  fs::remove(disk_.file("commissioned.copy"));
  const ProgramOutput refused = ask({});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.text, Names("commissioned.toml [state] folder"));
}

TEST_F(DyingDisk, MountedLateItsTripCounts) {
  disk_.unmount();
  ASSERT_NO_FATAL_FAILURE(start_and_run(false));
  end_tripped();
  fs::rename(disk_.folder(), site_.folder.file("card"));
  fs::create_directory(disk_.folder());
  commission(false);
  start();  // on the folder below, without state
  ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
  said_.clear();
  disk_.mount_late(site_.folder.file("card"));
  said_ += controller_->read_all();  // it ends by itself
  EXPECT_EQ(controller_->wait(), 0);
  EXPECT_THAT(said_, HasSubstr("mode=stopping"));
  said_.clear();
  start();
  EXPECT_NE(await_cycle("reason", "wrong_direction", 6), "") << said_;
  end_run();
  EXPECT_THAT(said_, Not(HasSubstr("mode=running")));
}

}  // namespace
}  // namespace bess
