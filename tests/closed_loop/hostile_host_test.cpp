// The real programs on a machine that is not on their side: prices that lie, configurations that
// lead past each other, a full disk, files of somebody else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>

#include "tests/support/simulated_site.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::int32_t kScale = 900;

class HostileHost : public ::testing::Test {
 protected:
  void start_simulators() {
    site_.start_battery();
    site_.start_market();
  }
  /// What a command of bess-edge says, and its exit code.
  std::string run(std::vector<std::string> arguments, int expected_exit_code) {
    arguments.insert(arguments.begin(), edge_program());
    ChildProcess child(arguments);
    std::string text = child.read_all();
    EXPECT_EQ(child.wait(), expected_exit_code) << text;
    return text;
  }

  /// The same configuration with `drive_without_state`.
  std::string allowing_to_drive(const std::string& config) {
    std::string text = text_of_file(config);
    const std::string section = "[state]\n";
    text.insert(text.find(section) + section.size(), "drive_without_state = true\n");
    return site_.folder.write("allowing.toml", text);
  }

  SimulatedSite site_{kScale};
};

TEST_F(HostileHost, CheckSaysOverWhatThePricesCome) {
  start_simulators();
  sleep_until_monotonic(site_.anchor_ns());
  EXPECT_THAT(run({"--check", "--config", site_.commission()}, 0),
              HasSubstr("\ntransport  plain http inside this machine\n"));
}

/// One row in ten cycles says 9,000 EUR/MWh: nothing is ordered by it.
TEST_F(HostileHost, ASinglePriceFarFromTheOthersIsNotActedOn) {
  std::string prices = "minute_utc,indicative_eur_mwh,settled_eur_mwh\n";
  for (int minute = -60; minute < 150; ++minute) {
    const char* const price = minute % 20 == 11 ? "9000" : "100";
    prices.append(utc_text(SimulatedSite::kStartS + 60 * minute).view())
        .append(",")
        .append(price)
        .append(",100\n");
  }
  site_.start_battery();
  site_.start_market({}, prices);
  const std::string config = site_.commission();
  EXPECT_THAT(run({"--config", config, "--cycles", "60"}, 0),
              HasSubstr(" step_held=1 held_centi=900000"));
  int held = 0;
  for (const CsvRow& row : read_csv(site_.folder.file("edge.csv"))) {
    EXPECT_NE(row.at("reason"), "price_high") << row.at("utc");
    EXPECT_NE(row.at("price_centi_eur_per_mwh"), "900000") << row.at("utc");
    if (row.at("step_held") == "1") ++held;
  }
  EXPECT_GT(held, 0);
}

TEST_F(HostileHost, AnotherLockFolderLetsNoSecondControllerIn) {
  start_simulators();
  const std::string mine = site_.commission();
  const std::string other = site_.commission({.state = "other"});
  fs::create_directory(site_.folder.file("elsewhere"));
  std::string text = text_of_file(other);
  const std::string key = "lock_folder = \"";
  text.insert(text.find(key) + key.size(), site_.folder.file("elsewhere") + "\" #");
  static_cast<void>(site_.folder.write("other.toml", text));
  ChildProcess edge({edge_program(), "--config", mine});
  for (std::string line; line != "started: in control";) {
    line = edge.read_line();
    ASSERT_NE(line, "") << "it did not start";
  }
  EXPECT_THAT(run({"--config", other, "--cycles", "1"}, 1),
              HasSubstr("is in use by another program (process " + std::to_string(edge.pid())));
}

TEST_F(HostileHost, AStrangersStatusIsNotBelieved) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to give a file to somebody else";
  start_simulators();
  const std::string config = site_.commission();
  const std::string status = site_.folder.file("state/status.json");
  static_cast<void>(site_.folder.write("state/status.json", "{\"health\": \"ok\", \"pid\": 1}"));
  ASSERT_EQ(chown(status.c_str(), 65'534, 65'534), 0);
  const std::string mend = "state/status.json belongs to user 65534, neither to root nor";
  EXPECT_THAT(run({"status", "--config", config}, 3), HasSubstr(mend));
  EXPECT_THAT(run({"--config", config, "--cycles", "1"}, 1), HasSubstr(mend));
}

/// A file system of its own in the place of the state folder.
class SmallDisk {
 public:
  explicit SmallDisk(std::string folder) : folder_(std::move(folder)) {
    fs::create_directory(folder_);
    is_mounted_ = mount("bess_test", folder_.c_str(), "tmpfs", 0, "size=14m") == 0;
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk() {
    if (is_mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  [[nodiscard]] bool is_mounted() const { return is_mounted_; }
  /// To the last byte.
  void fill() const {
    std::ofstream filler(folder_ + "/filler", std::ios::app);
    while (filler << std::string(1024, 'x') << std::flush) continue;
  }

 private:
  std::string folder_;
  bool is_mounted_ = false;
};

TEST_F(HostileHost, AFullDiskForbidsNoRestart) {
  const SmallDisk disk(site_.folder.file("state"));
  if (!disk.is_mounted()) GTEST_SKIP() << "needs root, to mount a small disk";
  start_simulators();
  const std::string config = site_.commission();
  run({"--config", config, "--cycles", "2"}, 0);
  // Whose room would be enough for new ones of as many pages, whatever stands in them.
  fs::remove(site_.folder.file("state/status.json"));
  fs::remove(site_.folder.file("state/metrics.prom"));
  disk.fill();
  const std::string restarted = run({"--config", config, "--cycles", "2"}, 0);
  EXPECT_THAT(restarted,
              AllOf(HasSubstr("started: in control"), HasSubstr("is the disk full or read-only?"),
                    HasSubstr("stopped: battery released")));
  const std::string log = run({"log", "--csv", "--config", config}, 0);
  EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 1 + 2 * 3) << "the log goes on in its place";

  // The log is gone, and a new one has no room: nobody knows whether it had tripped.
  fs::remove(site_.folder.file("state/decisions.ring"));
  disk.fill();
  EXPECT_THAT(
      run({"--config", config, "--cycles", "2"}, 0),
      AllOf(HasSubstr("the decision log can be neither read nor made"),
            HasSubstr("not driven until bess-edge clear --yes"), HasSubstr("reason=state_lost"),
            Not(HasSubstr("mode=running")), Not(HasSubstr("is driven on"))));
  EXPECT_THAT(run({"--config", allowing_to_drive(config), "--cycles", "2"}, 0),
              AllOf(HasSubstr("driving all the same"), HasSubstr("mode=running"),
                    HasSubstr("stopped: battery released")));
}

}  // namespace
}  // namespace bess
