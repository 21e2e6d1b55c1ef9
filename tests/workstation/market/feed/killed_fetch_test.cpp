// The program itself, killed at random while it downloads: whatever lies under a final name is whole
// and right, an earlier file stays until the new one is, and the next run goes on and cleans up.
#include <gmock/gmock.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "shared/host/file.h"
#include "tests/support/child_process.h"
#include "tests/support/market_test_support.h"
#include "tests/workstation/market/feed/fake_elia.h"
#include "workstation/base/random.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
constexpr std::uint64_t kSeed = 20230401;

class KilledFetch : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> command(const fs::path& out) const {
    return {BESS_TRAIN_PROGRAM, "prices", "fetch",      "--from",     "2023-02-01",    "--to",
            "2023-04-30",       "--out",  out.string(), "--base-url", elia_.base_url()};
  }

  /// What a file says without its provenance, which holds the time of the download.
  static std::string rows_of(const fs::path& path) {
    const std::string text = read_file(path);
    return text.substr(text.find("minute_utc"));
  }

  FakeElia elia_{{}, FakeRows::kAll};
  ScratchFolder folder_;
};

TEST_F(KilledFetch, FiftyTimesAtRandomLeavesNoWrongOrPartialFile) {
  const fs::path whole = folder_ / "whole.csv.gz";
  const auto start = Clock::now();
  ASSERT_EQ(ChildProcess(command(whole)).wait(), 0);
  const std::chrono::duration<double> whole_s = Clock::now() - start;
  const std::string expected = rows_of(whole);

  const fs::path out = folder_ / "prices.csv.gz";
  const std::string earlier = "minute_utc,indicative_eur_mwh,settled_eur_mwh\n";
  write_file(out, earlier);
  Random random(kSeed);
  int finished = 0;
  for (int kill_number = 0; kill_number < 50; ++kill_number) {
    ChildProcess fetch(command(out));
    std::this_thread::sleep_for(random.uniform() * whole_s);
    fetch.signal(kill_number % 5 == 4 ? SIGTERM : SIGKILL);
    const int exit_code = fetch.wait();
    ASSERT_THAT(exit_code, testing::AnyOf(0, 3, 128 + SIGTERM, 128 + SIGKILL)) << fetch.read_all();
    const std::string found = rows_of(out);  // throws when it is not a whole gzip file
    ASSERT_TRUE(found == earlier || found == expected) << "after kill " << kill_number;
    ASSERT_TRUE(exit_code != 0 || found == expected);
    if (found == expected) {  // begin anew, or the rest of the kills would hit nothing
      ++finished;
      write_file(out, earlier);
      fs::remove_all(out.string() + ".fetch");
    }
  }
  EXPECT_LT(finished, 50);
  ASSERT_EQ(ChildProcess(command(out)).wait(), 0);
  EXPECT_EQ(rows_of(out), expected);
  for (const auto& entry : fs::directory_iterator(out.parent_path())) {
    EXPECT_THAT(entry.path(), testing::AnyOf(out, whole)) << "left behind";
  }
}

TEST_F(KilledFetch, CtrlCSaysHowToGoOn) {
  const fs::path out = folder_ / "prices.csv";
  ChildProcess fetch(command(out));
  while (elia_.requests().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  fetch.signal(SIGINT);
  EXPECT_THAT(fetch.read_all(), testing::AllOf(testing::HasSubstr("finished windows are kept"),
                                               testing::HasSubstr("interrupted")));
  EXPECT_EQ(fetch.wait(), 3);
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace bess
