// The program itself, killed while it downloads, at each request and at random: whatever lies under
// a final name is whole and right, an earlier file stays until the new one is, and the next run
// goes on and cleans up.
#include <gmock/gmock.h>
#include <signal.h>

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <thread>

#include "shared/host/child_process.h"
#include "shared/host/file.h"
#include "tests/support/market_test_support.h"
#include "tests/workstation/market/feed/fake_elia.h"
#include "workstation/base/random.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
constexpr std::uint64_t kSeed = 20230401;

/// Holds one request of the program, so that it is interrupted while it waits for the answer.
class Gate {
 public:
  /// The `number`-th request from now on, 1 the next, is not answered before let_go().
  void hold(int number) {
    const std::lock_guard lock(mutex_);
    passing_ = number - 1;
    is_closed_ = true;
    is_reached_ = false;
  }
  [[nodiscard]] bool is_reached_within(std::chrono::seconds longest) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, longest, [this] { return is_reached_; });
  }
  void let_go() {
    const std::lock_guard lock(mutex_);
    is_closed_ = false;
    changed_.notify_all();
  }
  /// For each request, on the server's thread.
  void pass() {
    std::unique_lock lock(mutex_);
    if (!is_closed_ || passing_-- > 0) return;
    is_reached_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return !is_closed_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int passing_ = 0;  ///< requests before the one that is held
  bool is_closed_ = false;
  bool is_reached_ = false;
};

class KilledFetch : public testing::Test {
 protected:
  /// Two months are four windows, minutes and quarter-hours.
  static constexpr int kWindows = 4;

  [[nodiscard]] std::vector<std::string> command(const fs::path& out) const {
    return {BESS_TRAIN_PROGRAM, "prices", "fetch",      "--from",     "2023-03-01",    "--to",
            "2023-04-30",       "--out",  out.string(), "--base-url", elia_.base_url()};
  }

  /// What a file says without its provenance, which holds the time of the download.
  static std::string rows_of(const fs::path& path) {
    const std::string text = read_file(path);
    return text.substr(text.find("minute_utc"));
  }

  static fs::path kept_windows_of(const fs::path& out) { return out.string() + ".fetch"; }
  static int windows_kept(const fs::path& out) {
    std::error_code absent;
    const fs::directory_iterator files(kept_windows_of(out), absent);
    return static_cast<int>(std::distance(begin(files), end(files)));
  }

  Gate gate_;
  FakeElia elia_{[this](const std::string&, int, httplib::Response&) {
                   gate_.pass();
                   return false;
                 },
                 FakeRows::kAll};
  ScratchFolder folder_;
};

TEST_F(KilledFetch, AtEachWindowKeepsThoseBefore) {
  const fs::path out = folder_ / "prices.csv";
  for (int kept = 1; kept < kWindows; ++kept) {
    gate_.hold(2);  // one new window comes, the next does not
    ChildProcess fetch(command(out));
    ASSERT_TRUE(gate_.is_reached_within(std::chrono::seconds(60)));
    fetch.signal(SIGKILL);
    ASSERT_EQ(fetch.wait(), 128 + SIGKILL);
    gate_.let_go();
    ASSERT_EQ(windows_kept(out), kept);
    ASSERT_FALSE(fs::exists(out));
  }
  ASSERT_EQ(ChildProcess(command(out)).wait(), 0);
  EXPECT_FALSE(fs::exists(kept_windows_of(out)));
  const std::map<std::string, int> requests = elia_.requests();
  EXPECT_EQ(requests.at("ods046") + requests.at("ods047"), kWindows + (kWindows - 1))
      << "a window that was kept is not asked for again";
}

TEST_F(KilledFetch, AtRandomLeavesNoWrongOrPartialFile) {
  constexpr int kKills = 20;
  const fs::path whole = folder_ / "whole.csv.gz";
  const auto start = Clock::now();
  ASSERT_EQ(ChildProcess(command(whole)).wait(), 0);
  const std::chrono::duration<double> whole_s = Clock::now() - start;
  const std::string expected = rows_of(whole);

  const fs::path out = folder_ / "prices.csv.gz";
  const std::string earlier = "minute_utc,indicative_eur_mwh,settled_eur_mwh\n";
  write_file(out, earlier);
  Random random(kSeed);
  int in_the_middle = 0;
  for (int kill_number = 0; kill_number < kKills; ++kill_number) {
    ChildProcess fetch(command(out));
    std::this_thread::sleep_for(random.uniform() * whole_s);
    fetch.signal(kill_number % 5 == 4 ? SIGTERM : SIGKILL);
    const int exit_code = fetch.wait();
    ASSERT_THAT(exit_code, testing::AnyOf(0, 3, 128 + SIGTERM, 128 + SIGKILL)) << fetch.read_all();
    const std::string found = rows_of(out);  // throws when it is not a whole gzip file
    ASSERT_TRUE(found == earlier || found == expected) << "after kill " << kill_number;
    ASSERT_TRUE(exit_code != 0 || found == expected);
    if (found == expected) {  // begin anew, or the rest of the kills would hit nothing
      write_file(out, earlier);
      fs::remove_all(kept_windows_of(out));
    } else if (windows_kept(out) > 0) {
      ++in_the_middle;
    }
  }
  EXPECT_GE(in_the_middle, kKills / 5) << "most kills came too early or too late to matter";
  ASSERT_EQ(ChildProcess(command(out)).wait(), 0);
  EXPECT_EQ(rows_of(out), expected);
  for (const auto& entry : fs::directory_iterator(out.parent_path())) {
    EXPECT_THAT(entry.path(), testing::AnyOf(out, whole)) << "left behind";
  }
}

TEST_F(KilledFetch, CtrlCWritesNoFile) {
  const fs::path out = folder_ / "prices.csv";
  gate_.hold(1);
  ChildProcess fetch(command(out));
  ASSERT_TRUE(gate_.is_reached_within(std::chrono::seconds(60)));
  fetch.signal(SIGINT);
  EXPECT_EQ(fetch.wait(), 3) << fetch.read_all();
  gate_.let_go();
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace bess
