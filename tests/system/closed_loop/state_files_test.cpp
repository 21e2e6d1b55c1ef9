// State files of controller and notifier, damaged between two runs of the real programs, drawn from
// a named seed over all files and all damage of a card. The sign check, a hold and the sent alerts
// survive in another copy, each loss is a line, and only data that was written is accepted.
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <random>

#include "tests/support/edge_answer.h"
#include "tests/support/fake_card.h"
#include "tests/support/thorough.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::int32_t kScale = 300;
constexpr std::uint32_t kSeed = 20'261'123;

struct StateFile {
  const char* path;          ///< in the site's folder
  bool is_written_at_start;  ///< the controller does not start if it cannot be replaced
  bool is_read = true;       ///< by any reader, while the other copy is younger
};
constexpr StateFile kFiles[] = {
    {"state/commissioned.toml", false},
    {"state/commissioned.copy", false},
    {"run/commissioned.toml", false},
    {"state/hold", false},
    {"run/hold", false},
    {"state/status.bin", true},
    {"run/status.bin", true},
    {"state/status.json", true, false},
    {"run/status.json", true, false},
    {"state/metrics.prom", true, false},
    {"run/metrics.prom", true, false},
    {"notify/told.json", false},
    {"notify_run/told.json", false},
};

enum class Damage { kFlip, kCut, kEmpty, kZeros, kFolder, kStranger };
constexpr Damage kDamages[] = {Damage::kFlip,  Damage::kCut,    Damage::kEmpty,
                               Damage::kZeros, Damage::kFolder, Damage::kStranger};
constexpr const char* kDamageNames[] = {"flipped bit", "cut",      "empty",
                                        "zeros",       "a folder", "a stranger's"};

/// An operator holds the battery at 0 W: the prices alone would discharge it.
class StateFiles : public SiteTest {
 protected:
  StateFiles() : SiteTest(kScale) {}
  static constexpr const char* kFolders[] = {"state", "run", "notify", "notify_run"};

  void SetUp() override {
    site_.start_battery();
    site_.start_market({}, SimulatedSite::flat_prices(6'000, 1'700));
    config_ =
        site_.commission({.guard_keys = "price_age_s_max = 1800\n",
                          .state_keys = "run_folder = \"" + site_.folder.file("run") + "\"\n"});
    add_notifier();
    ASSERT_EQ(ask({"hold", "0", "--for", "7d"}).exit_code, 0);
    ASSERT_THAT(run_controller(), AllOf(HasSubstr("reason=held"), Not(HasSubstr("commissioned"))));
    ASSERT_THAT(notify(), HasSubstr("ALERT: CRITICAL "));
    newest_utc_ = edge_log().back().at("utc");
    newest_local_ = local_text_of(newest_utc_);
    for (const char* folder : kFolders) {
      std::error_code error;  // bess-prices may just be leaving it
      do {
        fs::remove_all(pristine(folder));
        fs::copy(site_.folder.file(folder), pristine(folder), fs::copy_options::recursive, error);
      } while (error);
    }
  }
  void add_notifier() {
    const std::string command =
        "{ echo \"Subject: $BESS_TITLE\"; cat; } >>" + site_.folder.file("mails");
    std::ofstream(config_, std::ios::app)
        << "[notify]\nafter_s = 0\nfolder = \"notify\"\nrun_folder = \"notify_run\"\ncommand = '"
        << command << "'\nprogram = \"" << edge_program() << "\"\n";
  }
  [[nodiscard]] std::string pristine(const char* folder) const {
    return site_.folder.file(std::string("pristine_") + folder);
  }
  void restore() {
    for (const char* folder : kFolders) {
      std::error_code error;  // bess-prices may just be leaving it
      do fs::remove_all(site_.folder.file(folder), error);
      while (error || fs::exists(site_.folder.file(folder)));
      fs::copy(pristine(folder), site_.folder.file(folder), fs::copy_options::recursive);
    }
  }
  std::string run_controller() {
    const ProgramOutput said = ask({"--cycles", "2"});
    exit_code_ = said.exit_code;
    return said.text;
  }
  std::string notify() {
    const ProgramOutput said = answer_of({BESS_NOTIFY_PROGRAM, "--once", "--config", config_});
    exit_code_ = said.exit_code;
    return said.text;
  }
  [[nodiscard]] std::size_t mails() const {
    return count_of(text_of_file(site_.folder.file("mails")), "Subject:");
  }

  void damage(const std::string& path, Damage how) {
    std::string text = text_of_file(path);
    ASSERT_FALSE(text.empty()) << path;
    const std::size_t at = random_() % text.size();
    switch (how) {
      case Damage::kFlip:
        text[at] = static_cast<char>(text[at] ^ (1 << random_() % 8));
        std::ofstream(path, std::ios::binary) << text;
        return;
      case Damage::kCut:
        return fs::resize_file(path, at);
      case Damage::kEmpty:
        return fs::resize_file(path, 0);
      case Damage::kZeros:
        std::ofstream(path, std::ios::binary) << std::string(text.size(), '\0');
        return;
      case Damage::kFolder:
        fs::remove(path);
        fs::create_directory(path);
        return;
      case Damage::kStranger:
        ASSERT_EQ(chown(path.c_str(), 65'534, 65'534), 0);
    }
  }

  /// Of a controller that has ended, with its newest control cycle: any program that reports it.
  void expect_status_is_true() {
    const ProgramOutput json = ask({"status", "--json"});
    EXPECT_EQ(json.exit_code, 3) << json.text;
    EXPECT_THAT(json.text, HasSubstr(newest_utc_));
    const ProgramOutput text = ask({"status"});
    EXPECT_EQ(text.exit_code, 3) << text.text;
    EXPECT_THAT(text.text, HasSubstr(newest_local_));
    const ProgramOutput metrics = ask({"status", "--prometheus"});
    EXPECT_THAT(metrics.text, AllOf(ContainsRegex("bess_tripped[{].*[}] 0\n"),
                                    HasSubstr("bess_last_cycle_timestamp_seconds{")))
        << metrics.text;
    said_ += json.text + text.text + metrics.text;
  }
  /// Sent alerts are not repeated.
  void expect_notifier_remembers() {
    const std::size_t before = mails();
    said_ += notify();
    EXPECT_EQ(exit_code_, 0) << said_;
    EXPECT_EQ(mails(), before) << said_;
  }
  void expect_driven_as_before(const StateFile& file, Damage how) {
    const std::string run = run_controller();
    said_ += run;
    const bool may_refuse =
        file.is_written_at_start && (how == Damage::kFolder || how == Damage::kStranger);
    if (may_refuse && exit_code_ == 1) {
      EXPECT_THAT(run, HasSubstr(site_.folder.file(file.path))) << "and nothing was driven";
      EXPECT_THAT(run, Not(HasSubstr("utc=")));
      return;
    }
    // A busy machine may reach the battery late; every order is the hold.
    EXPECT_LE(exit_code_, 1) << run;
    EXPECT_GE(count_of(run, " mode=running "), 1U) << run;
    EXPECT_EQ(count_of(run, " ordered_power_w=0 reason=held "), count_of(run, " mode=running "))
        << run;
  }
  void try_one(const StateFile& file, Damage how) {
    SCOPED_TRACE(std::string(file.path) + ", " + kDamageNames[static_cast<int>(how)]);
    restore();
    said_.clear();
    const std::string path = site_.folder.file(file.path);
    const std::string before = text_of_file(path);
    damage(path, how);
    fs::last_write_time(path, fs::file_time_type::clock::now());  // the younger copy is examined
    expect_status_is_true();
    expect_notifier_remembers();
    expect_driven_as_before(file, how);
    // A flip in the words around the checksum only removes the checksum.
    const bool is_of_the_words = how == Damage::kFlip || how == Damage::kCut;
    EXPECT_TRUE(said_.find(path) != std::string::npos || is_of_the_words || !file.is_read) << said_;
  }

  std::string newest_utc_, newest_local_;
  std::string said_;
  int exit_code_ = 0;
  std::mt19937 random_{kSeed};
};

TEST_F(StateFiles, NoDamageOfACardLosesOrFakesState) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to give a file to another user";
  for (int i = 0; i < few_or_all(4, 150); ++i) {
    const StateFile& file = kFiles[random_() % std::size(kFiles)];
    try_one(file, kDamages[random_() % std::size(kDamages)]);
  }
}

/// If each copy of the sign check is lost, control is refused; if each copy of the hold is lost, it
/// is reported and not followed.
TEST_F(StateFiles, AllCopiesLostIsSaidAndNotDefaulted) {
  for (const char* path : {"state/hold", "run/hold"}) {
    std::ofstream(site_.folder.file(path)) << std::string(73, '\0');
  }
  const std::string without_hold = run_controller();
  EXPECT_EQ(exit_code_, 0);
  EXPECT_THAT(without_hold, AllOf(Names("hold [state] folder"), Not(HasSubstr("reason=held"))));
  restore();
  for (const char* path :
       {"state/commissioned.toml", "state/commissioned.copy", "run/commissioned.toml"}) {
    std::ofstream(site_.folder.file(path)) << "map = \"si";
  }
  const std::string refused = run_controller();
  EXPECT_EQ(exit_code_, 1);
  EXPECT_THAT(refused, AllOf(Names("commissioned.toml bess-edge commission --config --yes"),
                             Not(HasSubstr("utc="))));
  const std::size_t before = mails();
  for (const char* path : {"notify/told.json", "notify_run/told.json"}) {
    std::ofstream(site_.folder.file(path)) << "{\"version\": 1, \"al";
  }
  EXPECT_THAT(notify(), Names("notify/told.json notify_run/told.json"));
  EXPECT_EQ(mails(), before + 1) << "reported again rather than never";
}

/// Wear of the state folder's card, if it reports any: in status, metrics and mail.
TEST_F(StateFiles, AWornCardIsReportedByAllPrograms) {
  const TemporaryFolder root;
  setenv("BESS_ROOT", root.file("").c_str(), 1);
  write_card(root, site_.folder.file("state"),
             {.life_time = "0x02 0x0a\n", .pre_eol_info = "0x03\n", .errors = "7\n"});
  ChildProcess running = controller();
  for (int cycles = 0; cycles < 2; ++cycles) await_line(running, "utc=");
  const std::string status = ask({"status"}).text;
  const std::string metrics = ask({"status", "--prometheus"}).text;
  const std::string reported = notify();
  EXPECT_EQ(SimulatedSite::stop(running), 0);
  unsetenv("BESS_ROOT");
  for (const std::string& text : {status, reported}) {
    EXPECT_THAT(text,
                AllOf(ContainsRegex("WARN [^\n]* 100 %"), ContainsRegex("CRITICAL [^\n]* 90 %"),
                      ContainsRegex("WARN [^\n]* 7 ")));
  }
  EXPECT_THAT(metrics, AllOf(ContainsRegex("bess_card_used_life_ratio[{].*[}] 1\n"),
                             ContainsRegex("bess_card_spare_level[{].*[}] 3\n"),
                             ContainsRegex("bess_file_system_errors[{].*[}] 7\n")));
  EXPECT_THAT(text_of_file(site_.folder.file("mails")), Names("CRITICAL 90 %"));
}

}  // namespace
}  // namespace bess
