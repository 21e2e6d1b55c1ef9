// A disk that dies under the real programs: full, read-only, without answer, gone, with flipped
// bytes. Whatever it does, status, metrics and alarms never say the opposite of what the controller
// has just decided, and a trip stays until a person clears it. Each row is printed; together they
// are the table.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <filesystem>
#include <functional>
#include <random>

#include "tests/support/edge_answer.h"
#include "tests/support/simulated_site.h"
#include "tests/support/thorough.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::int32_t kScale = 300;
constexpr int kCyclesToTrip = 12;  ///< at most, with the change of the battery in between

std::string text_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The word behind "NAME=" of a journal line.
std::string word_of(const std::string& line, const std::string& name) {
  const std::size_t at = line.find(name + "=");
  if (at == std::string::npos) return "";
  const std::size_t begin = at + name.size() + 1;
  return line.substr(begin, line.find(' ', begin) - begin);
}

/// As the metrics have it.
std::string utc_number(const std::string& utc) {
  std::int64_t utc_s = 0;
  EXPECT_TRUE(parse_utc(utc, utc_s)) << utc;
  return std::to_string(utc_s);
}

/// As a boot does; bess-prices may just be leaving it.
void lose_folder(const std::string& folder) {
  std::error_code error;
  do fs::remove_all(folder, error);
  while (error || fs::exists(folder));
}

/// The state folder as a disk of its own, and what can happen to it.
class StateDisk {
 public:
  explicit StateDisk(const SimulatedSite& site)
      : folder_(site.folder.file("state")), control_(site.folder.file("dying_disk")) {
    fs::create_directory(folder_);
    is_mounted_ = has_own_mounts() && mount_tmpfs("size=30m");
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

  /// As small as that from the start.
  bool become_tiny() {
    umount2(folder_.c_str(), MNT_DETACH);
    return mount_tmpfs("size=64k");
  }
  /// A file system of a card's kind, on a file. False where that is not allowed here.
  bool become_ext4(const std::string& image) {
    umount2(folder_.c_str(), MNT_DETACH);
    const std::string make = "truncate -s 40M " + image + " && mkfs.ext4 -q -F " + image +
                             " && mount -o loop,errors=remount-ro " + image + " " + folder_;
    return std::system((make + " 2>/dev/null").c_str()) == 0;
  }
  /// What the kernel does to a card after an error, under whatever has files open. No shim has a
  /// part in it.
  void fail_for_real() const {
    struct stat at {};
    ASSERT_EQ(stat(folder_.c_str(), &at), 0);
    const auto device = fs::canonical("/sys/dev/block/" + std::to_string(major(at.st_dev)) + ":" +
                                      std::to_string(minor(at.st_dev)));
    std::ofstream("/sys/fs/ext4/" + device.filename().string() + "/trigger_fs_error") << "1\n"
                                                                                      << std::flush;
    EXPECT_LT(open(file("probe").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600), 0);
    EXPECT_EQ(errno, EROFS);
  }
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
  /// What is mounted goes, under whatever has files open; the folder below it stays, empty.
  void unmount() {
    EXPECT_EQ(umount2(folder_.c_str(), MNT_DETACH), 0);
    is_mounted_ = false;
  }
  /// Another folder is seen there from now on, as a disk that comes late.
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
  /// What is mounted here goes with this process, however it ends.
  static bool has_own_mounts() {
    static const bool is_done =
        unshare(CLONE_NEWNS) == 0 && mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
    return is_done;
  }
  bool mount_tmpfs(const char* size) const {
    return mount("bess_test", folder_.c_str(), "tmpfs", 0, size) == 0;
  }

  std::string folder_;
  std::string control_;
  bool is_mounted_ = false;
};

class DyingDisk : public ::testing::Test {
 protected:
  DyingDisk() : disk_(site_) {}

  void SetUp() override {
#ifdef BESS_SANITIZED
    GTEST_SKIP() << "a sanitizer's runtime must come before LD_PRELOAD";
#endif
    if (!disk_.is_mounted()) GTEST_SKIP() << "needs root, to mount a small disk";
    site_.start_battery();
    site_.start_market({}, SimulatedSite::minute_prices(
                               6'000, {.mean_eur_per_mwh = 1'700, .amplitude_eur_per_mwh = 0}));
  }

  void commission(bool has_run_folder, const std::string& keys = "") {
    const std::string run = "run_folder = \"" + site_.folder.file("run") + "\"\n";
    config_ =
        site_.commission({.guard_keys = "price_age_s_max = 1800\n",  // it is stopped to be asked
                          .state_keys = (has_run_folder ? run : "") + keys});
  }
  void start() {
    controller_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{edge_program(), "--config", config_});
  }
  /// The first line of a cycle that has this word, among so many; empty when none has.
  std::string await_cycle(const std::string& name, const std::string& word, int cycles_max) {
    for (int cycle = 0; cycle < cycles_max;) {
      const std::string line = controller_->read_line();
      if (line.empty()) return "";
      said_ += line + "\n";
      if (!line.starts_with("utc=")) continue;
      ++cycle;
      if (word_of(line, name) == word) return line;
    }
    return "";
  }
  /// Another battery at the same place, whose power goes the other way.
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
  void end_run() {
    EXPECT_EQ(SimulatedSite::stop(*controller_), 0);
    said_ += controller_->read_all();
  }

  struct Answers {
    CsvRow decided;  ///< the newest cycle, by the CSV, which lies on another disk
    std::string status;
    std::string json;
    std::string metrics;
  };
  /// Asks everybody while the controller stands still.
  Answers ask_all() {
    controller_->signal(SIGSTOP);
    Answers answers;
    answers.decided = read_csv(site_.folder.file("edge.csv")).back();
    answers.status = edge({"status", "--config", config_}).text;
    answers.json = edge({"status", "--json", "--no-lock", "--config", config_}).text;
    answers.metrics = edge({"status", "--prometheus", "--config", config_}).text;
    controller_->signal(SIGCONT);
    return answers;
  }

  /// What everybody says of the controller is what it has just decided. Asked again when it was
  /// stopped between deciding and telling.
  void expect_all_agree(bool may_be_unknown) {
    Answers answers = ask_all();
    for (int i = 0; i < 20; ++i) {
      const std::string& utc = answers.decided.at("utc");
      const bool is_told = answers.status.find(local_text_of(utc)) != std::string::npos &&
                           answers.json.find(utc) != std::string::npos &&
                           answers.metrics.find(utc_number(utc)) != std::string::npos;
      if (is_told || may_be_unknown) break;
      usleep(40'000);
      answers = ask_all();
    }
    const std::string& utc = answers.decided.at("utc");
    const std::string& reason = answers.decided.at("reason");
    const bool is_tripped = answers.decided.at("trip") != "none";
    for (const std::string& text : {answers.status, answers.json}) {
      EXPECT_THAT(text, Not(HasSubstr("no bess-edge runs"))) << utc;
      const bool is_unknown = text.find("unknown: ") != std::string::npos;
      EXPECT_TRUE(may_be_unknown || !is_unknown) << text;
      if (is_unknown) {
        EXPECT_THAT(text, AllOf(HasSubstr("CRITICAL: unknown: "), Not(HasSubstr("in control"))));
        continue;
      }
      EXPECT_THAT(text,
                  AllOf(AnyOf(HasSubstr(utc), HasSubstr(local_text_of(utc))), HasSubstr(reason)));
      if (is_tripped) {
        EXPECT_THAT(text, AllOf(HasSubstr("CRITICAL: tripped"), Not(HasSubstr("health     ok"))));
      }
    }
    if (may_be_unknown) return;
    EXPECT_THAT(
        answers.metrics,
        AllOf(
            ContainsRegex(is_tripped ? "bess_tripped[{].*[}] 1\n" : "bess_tripped[{].*[}] 0\n"),
            ContainsRegex("bess_last_cycle_timestamp_seconds[{].*[}] " + utc_number(utc) + "\n")));
  }

  void print_row(const char* what, const std::string& outcome) {
    if (!HasFailure()) std::printf("| %-52s | %s |\n", what, outcome.c_str());
  }

  SimulatedSite site_{kScale};
  StateDisk disk_;
  std::string config_;
  std::unique_ptr<ChildProcess> controller_;
  std::string said_;
};

/// The disk dies under a running controller, which then trips.
struct Death {
  const char* name;
  void (*happen)(const StateDisk& disk);
  bool log_lives;        ///< the ring, in its file of fixed size
  bool is_real = false;  ///< by the kernel alone, for good
};
constexpr Death kDeaths[] = {
    {"full", [](const StateDisk& disk) { disk.fill(); }, true},
    {"read-only", [](const StateDisk& disk) { disk.go_read_only(); }, false},
    {"I/O errors", [](const StateDisk& disk) { disk.go_silent(); }, false},
    {"ext4 error", [](const StateDisk& disk) { disk.fail_for_real(); }, false, true},
};

std::string name_of_death(const ::testing::TestParamInfo<Death>& info) {
  return std::string(info.param.name) == "full" ? "Full"
         : info.param.name[0] == 'r'            ? "ReadOnly"
         : info.param.is_real                   ? "Ext4Error"
                                                : "IoErrors";
}

class DyingDiskRun : public DyingDisk, public ::testing::WithParamInterface<Death> {
 protected:
  void SetUp() override {
    DyingDisk::SetUp();
    if (IsSkipped() || !GetParam().is_real) return;
    if (!disk_.become_ext4(site_.folder.file("card"))) {
      GTEST_SKIP() << "no loop device or mkfs.ext4 here: a real error of a card is not tried";
    }
  }
};

TEST_P(DyingDiskRun, WithARunFolderAllSayWhatIsAndTheTripStays) {
  commission(true);
  start();
  ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
  GetParam().happen(disk_);
  ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
  expect_all_agree(false);
  trip();
  ASSERT_NE(await_cycle("reason", "wrong_direction", 6), "") << said_;
  expect_all_agree(false);
  swap_battery(false);
  end_run();

  start();  // on the dead disk
  EXPECT_NE(await_cycle("reason", "wrong_direction", 6), "") << said_;
  ASSERT_NE(await_cycle("reason", "wrong_direction", 6), "") << said_;
  expect_all_agree(false);
  const Said cleared = edge({"clear", "--yes", "--config", config_});
  EXPECT_EQ(cleared.exit_code, 0) << cleared.text;
  EXPECT_THAT(cleared.text, AllOf(HasSubstr("driven again"), HasSubstr("next boot")));
  EXPECT_NE(await_cycle("mode", "running", 8), "") << said_;
  ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
  expect_all_agree(false);
  end_run();

  start();  // what was cleared stays cleared
  EXPECT_NE(await_cycle("mode", "running", 8), "") << said_;
  disk_.free_again();
  disk_.come_back();
  ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
  expect_all_agree(false);
  end_run();
  if (!GetParam().log_lives && !GetParam().is_real) {
    EXPECT_THAT(said_, AllOf(HasSubstr("is the disk full or read-only?"),
                             HasSubstr("the decision log goes on: ")));
  }
  print_row((std::string(GetParam().name) + " amid a run, run folder").c_str(),
            "all agree, trip kept, cleared, kept cleared");
}

TEST_P(DyingDiskRun, WithoutARunFolderTheyKnowOrSayThatTheyDoNot) {
  commission(false);
  start();
  ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
  GetParam().happen(disk_);
  await_cycle("mode", "running", 8);
  trip();
  for (int cycle = 0; cycle < 5; ++cycle) await_cycle("reason", "wrong_direction", 6);
  expect_all_agree(!GetParam().log_lives);
  end_run();
  print_row((std::string(GetParam().name) + " amid a run, no run folder").c_str(),
            GetParam().log_lives ? "all agree, by the log" : "status says unknown, CRITICAL");
}

INSTANTIATE_TEST_SUITE_P(All, DyingDiskRun, ::testing::ValuesIn(kDeaths), name_of_death);

#ifdef BESS_NOTIFY_PROGRAM

/// The notifier on the same disk: it tells what is, and what it cannot keep itself.
class DyingDiskNotify : public DyingDiskRun {
 protected:
  void add_notifier() const {
    const std::string command =
        "{ echo \"Subject: $BESS_TITLE\"; cat; } >>" + site_.folder.file("mails");
    std::ofstream(config_, std::ios::app)
        << "[notify]\nevery_s = 1\nafter_s = 0\nfolder = \"state/notify\"\nrun_folder = "
           "\"run/notify\"\ncommand = '"
        << command << "'\nprogram = \"" << edge_program() << "\"\n";
  }
  void start_notifier() {
    notifier_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{BESS_NOTIFY_PROGRAM, "--config", config_});
  }
  [[nodiscard]] std::size_t mails_with(const std::string& piece) const {
    const std::string mails = text_of_file(site_.folder.file("mails"));
    std::size_t count = 0;
    for (std::size_t at = mails.find(piece); at != mails.npos; at = mails.find(piece, at + 1)) {
      ++count;
    }
    return count;
  }
  /// False after half a minute. The controller's lines are read meanwhile, so that it never waits
  /// for a reader.
  bool is_mailed(const std::string& piece) {
    for (int cycle = 0; cycle < 90 && mails_with(piece) == 0; ++cycle) await_cycle("mode", "-", 1);
    return mails_with(piece) > 0;
  }

  std::unique_ptr<ChildProcess> notifier_;
};

TEST_P(DyingDiskNotify, TellsEachAlarmOnceAndWhatItCannotKeep) {
  const bool is_of_every_day = std::string(GetParam().name) == "read-only";
  if (few_or_all(0, 1) == 0 && !is_of_every_day) GTEST_SKIP() << "only with BESS_THOROUGH";
  commission(true);
  add_notifier();
  start();
  ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
  start_notifier();
  GetParam().happen(disk_);
  EXPECT_TRUE(is_mailed("ALARM: WARN: the ")) << "the disk";
  EXPECT_TRUE(is_mailed(disk_.file("notify/told.json") + ": cannot be written: "));
  EXPECT_GT(mails_with("what is reported is kept in " + site_.folder.file("run/notify/told.json")),
            0U);
  trip();
  EXPECT_TRUE(is_mailed("ALARM: CRITICAL: tripped")) << said_;
  for (int cycle = 0; cycle < 5; ++cycle) await_cycle("mode", "-", 1);  // until that is kept
  notifier_->signal(SIGKILL);
  notifier_->wait();
  start_notifier();
  for (int cycle = 0; cycle < 10; ++cycle) await_cycle("mode", "-", 1);
  EXPECT_EQ(mails_with("ALARM: CRITICAL: tripped"), 1U) << "memory knows that it was told";
  EXPECT_EQ(mails_with("over: CRITICAL: tripped"), 0U) << "it is not over";
  swap_battery(false);
  ASSERT_EQ(edge({"clear", "--yes", "--config", config_}).exit_code, 0);
  EXPECT_TRUE(is_mailed("over: CRITICAL: tripped"));
  EXPECT_EQ(SimulatedSite::stop(*notifier_), 0);
  end_run();
  print_row((std::string(GetParam().name) + ", the notifier on it as well").c_str(),
            "each alarm once, what is not kept is told");
}

INSTANTIATE_TEST_SUITE_P(All, DyingDiskNotify, ::testing::ValuesIn(kDeaths), name_of_death);

#endif

/// What happens to the disk between a run that has tripped and the next start.
struct Accident {
  const char* name;
  const char* what;
  void (*happen)(const StateDisk& disk);
  bool boots;            ///< the run folder is empty again
  const char* expected;  ///< the reason of the next run's cycles
  const char* line;      ///< of its journal
};

std::uintmax_t place_of_record(std::uintmax_t number) { return 4'096 + 512 * number; }

constexpr Accident kAccidents[] = {
    {"ReadOnly", "read-only at the start, run folder",
     [](const StateDisk& disk) { disk.go_read_only(); }, false, "wrong_direction", ""},
    {"ReadOnlyAfterABoot", "read-only at the start, after a boot",
     [](const StateDisk& disk) { disk.go_read_only(); }, true, "wrong_direction", ""},
    {"Remounted", "remounted read-only by mount(8), run folder",
     [](const StateDisk& disk) { disk.remount_read_only(); }, false, "wrong_direction", ""},
    {"RemountedAfterABoot", "remounted read-only by mount(8), after a boot",
     [](const StateDisk& disk) { disk.remount_read_only(); }, true, "wrong_direction", ""},
    {"Full", "full at the start, run folder", [](const StateDisk& disk) { disk.fill(); }, false,
     "wrong_direction", ""},
    {"FullAfterABoot", "full at the start, after a boot",
     [](const StateDisk& disk) { disk.fill(); }, true, "wrong_direction", ""},
    {"HeaderGone", "both headers of the log gone, after a boot",
     [](const StateDisk& disk) { disk.flip("decisions.ring", 0, 4'096); }, true, "wrong_direction",
     "header and copy were broken, and are made anew"},
    {"LogGone", "the log removed, run folder", [](const StateDisk& disk) { disk.go_away(); }, false,
     "wrong_direction", ""},
    {"LogGoneAfterABoot", "the log removed, after a boot",
     [](const StateDisk& disk) { disk.go_away(); }, true, "state_lost",
     "the decision log is gone, although a controller has run here"},
    {"LogGarbageAfterABoot", "the log overwritten, after a boot",
     [](const StateDisk& disk) { disk.flip("decisions.ring", 0, 4'096 + 512 * 64); }, true,
     "state_lost", "nothing in the decision log can be understood"},
    {"LogCutAfterABoot", "the log cut short, after a boot",
     [](const StateDisk& disk) {
       fs::resize_file(disk.file("decisions.ring"), place_of_record(3));
     },
     true, "state_lost", "its end is cut off"},
    {"LogEmptyAfterABoot", "the log without a byte, after a boot",
     [](const StateDisk& disk) { fs::resize_file(disk.file("decisions.ring"), 0); }, true,
     "state_lost", "nothing in the decision log can be understood"},
};

class DyingDiskStart : public DyingDisk, public ::testing::WithParamInterface<Accident> {};

TEST_P(DyingDiskStart, ATripIsNotForgotten) {
  commission(true);
  start();
  ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
  trip();
  await_cycle("reason", "wrong_direction", 6);
  end_run();
  swap_battery(false);
  said_.clear();
  GetParam().happen(disk_);
  if (GetParam().boots) lose_folder(site_.folder.file("run"));

  start();
  EXPECT_NE(await_cycle("reason", GetParam().expected, 6), "") << said_;
  EXPECT_THAT(said_, AllOf(HasSubstr(GetParam().line), Not(HasSubstr("mode=running"))));
  ASSERT_NE(await_cycle("reason", GetParam().expected, 6), "") << said_;
  expect_all_agree(false);
  const Said cleared = edge({"clear", "--yes", "--config", config_});
  EXPECT_EQ(cleared.exit_code, 0) << cleared.text;
  EXPECT_NE(await_cycle("mode", "running", 8), "") << said_;
  end_run();
  print_row(GetParam().what, std::string(GetParam().expected) + ", told, cleared");
}

INSTANTIATE_TEST_SUITE_P(All, DyingDiskStart, ::testing::ValuesIn(kAccidents),
                         [](const auto& info) { return std::string(info.param.name); });

/// What people say to the controller while its disk takes nothing.
class DyingDiskWords : public DyingDisk {
 protected:
  Said hold(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "hold");
    arguments.insert(arguments.end(), {"--config", config_});
    return edge(std::move(arguments));
  }
  void break_disk(bool is_full) { is_full ? disk_.fill() : disk_.go_read_only(); }
  void mend_disk(bool is_full) { is_full ? disk_.free_again() : disk_.come_back(); }
};

TEST_F(DyingDiskWords, WithoutARunFolderAHoldThatCannotBeWrittenLeavesTheOneBefore) {
  commission(false);
  ASSERT_EQ(hold({"-1000", "--for", "2h"}).exit_code, 0);
  const std::string before = text_of_file(disk_.file("hold"));
  ASSERT_FALSE(before.empty());
  for (const bool is_full : {true, false}) {
    break_disk(is_full);
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"2000", "--for", "1h"}, {"--release"}}) {
      if (is_full && arguments.size() == 1) continue;  // what goes needs no room
      const Said said = hold(arguments);
      EXPECT_EQ(said.exit_code, 1) << said.text;
      EXPECT_THAT(said.text, AllOf(HasSubstr(is_full ? "No space left" : "Read-only file system"),
                                   AnyOf(HasSubstr("nothing has changed"),
                                         HasSubstr("it is still in force"))));
      EXPECT_EQ(text_of_file(disk_.file("hold")), before);
    }
    mend_disk(is_full);
  }
  EXPECT_EQ(hold({"2000", "--for", "1h"}).exit_code, 0);
  EXPECT_NE(text_of_file(disk_.file("hold")), before);
  print_row("hold, release on a full or read-only disk, no run folder",
            "refused, the one before holds");
}

TEST_F(DyingDiskWords, ALimitThatCannotBeWrittenLeavesTheOneBefore) {
  commission(true);
  std::ofstream(config_, std::ios::app) << "[limits]\nfile = \"" << disk_.file("limit") << "\"\n";
  const auto limit = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "limit");
    arguments.insert(arguments.end(), {"--config", config_});
    return edge(std::move(arguments));
  };
  ASSERT_EQ(limit({"--charge", "2000", "--for", "15m"}).exit_code, 0);
  const std::string before = text_of_file(disk_.file("limit"));
  ASSERT_FALSE(before.empty());
  for (const bool is_full : {true, false}) {
    break_disk(is_full);
    const Said other = limit({"--charge", "1000", "--for", "15m"});
    EXPECT_EQ(other.exit_code, 1) << other.text;
    EXPECT_THAT(other.text, AllOf(HasSubstr(is_full ? "No space left" : "Read-only file system"),
                                  HasSubstr("nothing has changed")));
    if (!is_full) {
      const Said cleared = limit({"--clear"});
      EXPECT_EQ(cleared.exit_code, 1) << cleared.text;
      EXPECT_THAT(cleared.text, HasSubstr("it stays in force until its end"));
    }
    EXPECT_EQ(text_of_file(disk_.file("limit")), before);
    mend_disk(is_full);
  }
  EXPECT_EQ(limit({"--clear"}).exit_code, 0);
  print_row("limit on a full or read-only disk", "refused, the one before holds");
}

/// [metrics] prometheus on the disk that dies, the state on a good one.
TEST_F(DyingDiskWords, MetricsThatCannotBeWrittenAreToldAndTheStateIsNot) {
  config_ = site_.write_config({.guard_keys = "price_age_s_max = 1800\n",
                                .state = "good",
                                .state_keys = "[metrics]\nprometheus = \"state/bess.prom\"\n"});
  ASSERT_EQ(edge({"commission", "--config", config_, "--yes"}).exit_code, 0);
  for (const bool is_full : {true, false}) {
    start();
    ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
    break_disk(is_full);
    for (int cycle = 0; cycle < 3; ++cycle) await_cycle("mode", "running", 8);
    const Said status = edge({"status", "--config", config_});
    EXPECT_EQ(status.exit_code, is_full ? 0 : 1)
        << "what is there can be replaced: " << status.text;
    EXPECT_THAT(status.text, HasSubstr("state      running at"));
    EXPECT_EQ(status.text.find("full or read-only?") == std::string::npos, is_full) << status.text;
    end_run();
    mend_disk(is_full);
  }
  EXPECT_THAT(said_, AllOf(HasSubstr("[metrics] cannot be written"),
                           HasSubstr("The battery is driven on"), Not(HasSubstr("state: "))));
}

TEST_F(DyingDiskWords, WithARunFolderTheNewestWordIsFollowedAndSaidToEndWithTheBoot) {
  for (const bool is_full : {true, false}) {
    lose_folder(site_.folder.file("run"));
    commission(true);
    start();
    ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
    ASSERT_EQ(hold({"-1000", "--for", "6h"}).exit_code, 0);
    ASSERT_NE(await_cycle("ordered_power_w", "-1000", 8), "") << said_;
    break_disk(is_full);
    const Said other = hold({"-2000", "--for", "6h"});
    EXPECT_EQ(other.exit_code, 0) << other.text;
    EXPECT_THAT(other.text, AllOf(HasSubstr(is_full ? "No space left" : "Read-only file system"),
                                  HasSubstr("which the next boot of this machine forgets")));
    EXPECT_NE(await_cycle("ordered_power_w", "-2000", 8), "") << said_;
    const Said released = hold({"--release"});
    EXPECT_EQ(released.exit_code, 0) << released.text;
    EXPECT_EQ(released.text.find("which the next boot") == std::string::npos, is_full)
        << "what goes needs no room: " << released.text;
    EXPECT_NE(await_cycle("ordered_power_w", "-4000", 8), "") << said_;
    end_run();
    EXPECT_THAT(said_, HasSubstr("hold: released; the prices decide again"));
    mend_disk(is_full);
    ASSERT_EQ(hold({"--release"}).exit_code, 0);
    for (const char* path : {"state/hold", "run/hold"}) {
      EXPECT_FALSE(fs::exists(site_.folder.file(path))) << path;
    }
    said_.clear();
  }
  print_row("hold, release on a full or read-only disk, run folder",
            "followed; kept until the boot, said");
}

TEST_F(DyingDisk, ANewBatteryStarts) {
  commission(true);
  start();
  EXPECT_NE(await_cycle("mode", "running", 8), "") << said_;
  end_run();
  EXPECT_THAT(said_, Not(HasSubstr("state: ")));
  print_row("first start", "driven");
}

/// It has never run here, and cannot keep anything: not driven, and said so, unless a key allows
/// it.
TEST_F(DyingDisk, FullOrReadOnlyFromTheStartItIsNotDrivenUnlessAllowed) {
  for (const Death& death : kDeaths) {
    if (std::string(death.name) == "I/O errors" || death.is_real)
      continue;  // not commissioned, as far as anybody can read
    for (const bool has_run_folder : {true, false}) {
      lose_folder(site_.folder.file("run"));
      commission(has_run_folder);
      death.happen(disk_);
      start();
      EXPECT_NE(await_cycle("reason", "state_lost", 6), "") << said_;
      ASSERT_NE(await_cycle("reason", "state_lost", 6), "") << said_;
      expect_all_agree(!has_run_folder);
      end_run();
      EXPECT_THAT(said_, HasSubstr("not driven until bess-edge clear --yes"));
      disk_.free_again();
      disk_.come_back();
      fs::remove(disk_.file("status.json"));

      lose_folder(site_.folder.file("run"));
      commission(has_run_folder, "drive_without_state = true\n");
      death.happen(disk_);
      start();
      EXPECT_NE(await_cycle("mode", "running", 8), "") << said_;
      ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
      expect_all_agree(!has_run_folder);
      end_run();
      EXPECT_THAT(said_, HasSubstr("driving all the same: drive_without_state = true"));
      disk_.free_again();
      disk_.come_back();
      for (const char* name : {"status.json", "decisions.ring", "metrics.prom"}) {
        fs::remove(disk_.file(name));
      }
      said_.clear();
    }
    print_row((std::string(death.name) + " from the first start").c_str(),
              "state_lost, told; driven with the key");
  }
}

/// The folder is suddenly empty: what was known goes on in it.
TEST_F(DyingDisk, UnmountedAmidARunItGoesOnInTheFolderBelow) {
  commission(true);
  start();
  ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
  disk_.unmount();
  for (int cycle = 0; cycle < 2; ++cycle) {
    ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
  }
  expect_all_agree(false);
  trip();
  await_cycle("reason", "wrong_direction", 6);
  expect_all_agree(false);
  end_run();
  EXPECT_THAT(said_, HasSubstr("the decision log is gone from its place, was its disk unmounted?"));
  swap_battery(false);
  said_.clear();
  start();  // with the sign check that memory has
  EXPECT_NE(await_cycle("reason", "wrong_direction", 6), "") << said_;
  end_run();
  EXPECT_THAT(said_,
              AllOf(HasSubstr("commissioned.toml is gone; "), Not(HasSubstr("mode=running"))));
  lose_folder(site_.folder.file("run"));  // and after a boot
  fs::remove(disk_.file("commissioned.toml"));
  fs::remove(disk_.file("commissioned.copy"));
  const Said refused = edge({"--config", config_});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.text, HasSubstr("or the disk of [state] folder is not mounted"));
  print_row("unmounted amid a run", "goes on below, trip kept");
}

/// A disk that is mounted after the start, and knows of a trip.
TEST_F(DyingDisk, MountedLateItsTripCounts) {
  disk_.unmount();
  commission(false);
  start();
  ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
  trip();
  await_cycle("reason", "wrong_direction", 6);
  end_run();
  swap_battery(false);
  fs::rename(disk_.folder(), site_.folder.file("card"));
  fs::create_directory(disk_.folder());
  commission(false);
  start();  // on the folder below, where nothing is known
  ASSERT_NE(await_cycle("mode", "running", 8), "") << said_;
  said_.clear();
  disk_.mount_late(site_.folder.file("card"));
  said_ += controller_->read_all();  // it ends by itself
  EXPECT_EQ(controller_->wait(), 0);
  EXPECT_THAT(said_, AllOf(HasSubstr("the state folder now holds another log"),
                           HasSubstr("stopped: battery released")));
  said_.clear();
  start();
  EXPECT_NE(await_cycle("reason", "wrong_direction", 6), "") << said_;
  end_run();
  EXPECT_THAT(said_, Not(HasSubstr("mode=running")));
  print_row("mounted late, with a trip in its log", "ends; the next start is tripped");
}

/// No room for the log, ever.
TEST_F(DyingDisk, OnADiskOfAFewKilobytesItIsNotDrivenAndThatIsSaid) {
  ASSERT_TRUE(disk_.become_tiny());
  commission(true);
  start();
  for (int cycle = 0; cycle < 2; ++cycle) {
    ASSERT_NE(await_cycle("reason", "state_lost", 6), "") << said_;
  }
  expect_all_agree(false);
  end_run();
  EXPECT_THAT(said_, AllOf(HasSubstr("the decision log can be neither read nor made"),
                           HasSubstr("What follows says whether the battery is driven"),
                           Not(HasSubstr("is driven on"))));
  print_row("a disk of 64 kB", "state_lost, told");
}

}  // namespace
}  // namespace bess
