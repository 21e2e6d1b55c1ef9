// Download program, killed at each request: an earlier file stays until the new one is complete,
// and the next run continues and cleans up.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>

#include "shared/host/child_process.h"
#include "shared/host/file.h"
#include "tests/support/fake_elia.h"
#include "tests/support/market_test_support.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

/// Delays one request of the program, so that it is interrupted while it waits for the answer.
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
    ++openings_;
    changed_.notify_all();
  }
  /// For each request, on the server's thread.
  void pass() {
    std::unique_lock lock(mutex_);
    if (!is_closed_ || passing_-- > 0) return;
    is_reached_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this, before = openings_] { return openings_ != before; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int openings_ = 0;
  int passing_ = 0;  ///< requests before the delayed one
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

  static fs::path kept_windows_of(const fs::path& out) { return out.string() + ".fetch"; }
  static int windows_kept(const fs::path& out) {
    std::error_code absent;
    const fs::directory_iterator files(kept_windows_of(out), absent);
    return static_cast<int>(std::distance(begin(files), end(files)));
  }

  Gate gate_;
  FakeElia elia_{[this](const EliaRequest& ask, EliaAnswer&) {
    if (!ask.wants_total) gate_.pass();
  }};
  ScratchFolder folder_;
};

TEST_F(KilledFetch, AtEachWindowKeepsThoseBefore) {
  const fs::path out = folder_ / "prices.csv.gz";
  write_file(out, "of before");
  for (int kept = 1; kept < kWindows; ++kept) {
    gate_.hold(2);  // one new window arrives, the next does not
    ChildProcess fetch(command(out));
    ASSERT_TRUE(gate_.is_reached_within(std::chrono::seconds(60)));
    fetch.signal(SIGKILL);
    ASSERT_EQ(fetch.wait(), 128 + SIGKILL);
    gate_.let_go();
    ASSERT_EQ(windows_kept(out), kept);
    ASSERT_EQ(read_file(out), "of before");
  }
  ASSERT_EQ(ChildProcess(command(out)).wait(), 0);
  EXPECT_EQ(std::ranges::count(read_file(out).substr(read_file(out).find("minute_utc")), '\n'),
            1 + (31 + 30) * 1440 - 60);
  EXPECT_EQ(std::distance(fs::directory_iterator(out.parent_path()), {}), 1) << "left behind";
  const std::map<std::string, int> requests = elia_.requests();
  EXPECT_EQ(requests.at("ods046") + requests.at("ods047"), kWindows + (kWindows - 1))
      << "a stored window is not fetched again";
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
