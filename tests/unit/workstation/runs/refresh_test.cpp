// bess-train refresh: killed at its stages it ends with the same bytes; an adopted candidate
// replaces the run, a worse one does not.
#include <gmock/gmock.h>
#include <signal.h>

#include <atomic>

#include "tests/support/fake_elia.h"
#include "tests/support/market_series.h"
#include "tests/support/tokens.h"
#include "tests/unit/workstation/data/market/feed/fake_charts.h"
#include "tests/unit/workstation/runs/idle_run.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

const std::string kIdleProgram = std::string(kIdleCosts) + kNoThresholds +
                                 "[distil]\nepochs = 12\nlearning_rate = 0.03\n"
                                 "[train]\nmethod = \"sdp\"\n";

class RefreshCommand : public IdleRun {
 protected:
  void make_run(const std::string& config, const MinuteSeries& series) const {
    write_minute_file(path("first.csv"), series, "");
    said({"run", "--prices", path("first.csv"), "--config", written("config.toml", config),
          "--threads", "2", "--out", path("site")});
  }
  [[nodiscard]] std::vector<std::string> command(const std::string& prices, bool adopt) const {
    std::vector<std::string> words{"refresh",    "--run",         path("site"), "--prices",
                                   path(prices), "--window-days", "30"};
    if (adopt) words.emplace_back("--adopt");
    return words;
  }
  [[nodiscard]] Result refresh(const std::string& prices, bool adopt = true) const {
    return run(command(prices, adopt));
  }
  [[nodiscard]] std::vector<std::string> folders() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(path("")))
      if (entry.is_directory()) names.push_back(entry.path().filename().string());
    std::ranges::sort(names);
    return names;
  }
};

/// As soon as `file` exists, and before the next stage has progressed; false if it ended before.
bool kill_once_there(const std::vector<std::string>& words, const fs::path& file) {
  ChildProcess program(words);
  while (!fs::exists(file) && !program.has_ended()) usleep(300);
  program.signal(SIGKILL);
  return program.wait() != 0;
}

TEST_F(RefreshCommand, KilledAtItsStagesEndsWithTheSameBytes) {
  EXPECT_THAT(refresh("next.csv").output, Names(path("site")));
  make_run(kIdleProgram, small_series(31));
  EXPECT_THAT(refresh("next.csv").output, Names("next.csv"));  // does not exist yet
  EXPECT_FALSE(fs::exists(path("site.proposal")));
  write_minute_file(path("next.csv"), small_series(36), "");  // trained to 25 January
  EXPECT_THAT(said(command("next.csv", true)), Names("2023-01-25 2023-02-05 14"));
  EXPECT_THAT(folders(), testing::ElementsAre("site"));
  write_minute_file(path("next.csv"), small_series(75), "");
  said(command("next.csv", false));
  const auto before = contents(path("site"));
  const auto whole = contents(path("site.proposal"));
  ASSERT_TRUE(whole.contains("proposal.json"));
  fs::remove_all(path("site.proposal"));

  std::vector<std::string> words = command("next.csv", true);
  words.insert(words.begin(), BESS_TRAIN_PROGRAM);
  int killed = 0;
  for (const char* stage : {"teacher.bin", "student.json"}) {
    killed += kill_once_there(words, path("site.proposal") + "/" + stage) ? 1 : 0;
    ASSERT_TRUE(fs::exists(path("site/student.json"))) << "the run remains until it is replaced";
  }
  EXPECT_GE(killed, 1);
  if (fs::exists(path("site.proposal"))) {
    EXPECT_THAT(refresh("next.csv").output, Names("site.before-2023-03-16"));
  }
  expect_same(path("site"), whole);
  expect_same(path("site.before-2023-03-16"), before);

  // Between the two renames: the run's place is empty, and the next call restores it.
  fs::rename(path("site"), path("site.proposal"));
  said(command("next.csv", true));
  expect_same(path("site"), whole);
  EXPECT_THAT(folders(), testing::ElementsAre("site", "site.before-2023-03-16"));

  // It is an ordinary run, in any folder.
  said({"report", "--run", path("site")});
  expect_same(path("site"), whole);
}

/// A month whose settled prices are dated a day late, with correct minutes.
MinuteSeries settled_a_day_late(const MinuteSeries& series, const char* from, const char* to) {
  MinuteSeries spoilt = series;
  for (std::size_t m = 1440; m < series.size(); ++m) {
    if (series.utc_s(m) < utc_of(from) || series.utc_s(m) >= utc_of(to)) continue;
    spoilt.settled[m] = series.settled[m - 1440];
  }
  return spoilt;
}

MinuteSeries until(MinuteSeries series, const char* end) {
  const auto minutes = static_cast<std::size_t>((utc_of(end) - series.start_utc_s) / 60);
  series.indicative.resize(minutes);
  series.settled.resize(minutes);
  return series;
}

// By outlook, on a simulated market with its day-ahead prices.
class RefreshedByOutlook : public RefreshCommand {
 protected:
  void simulate(const char* days, const char* name) const {
    said({"prices", "simulate", "--start", "2023-01-01", "--days", days, "--out", path(name),
          "--day-ahead-out", path("outlook.csv")});
  }
  [[nodiscard]] Result begun(const std::vector<std::string>& more) const {
    const std::string config = written("config.toml", kIdleProgram + "context = \"outlook\"\n");
    std::vector<std::string> words{"run",  "--prices", path("first.csv"), "--config",
                                   config, "--out",    path("site")};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
};

TEST_F(RefreshedByOutlook, BringsItsDayAheadPricesAlong) {
  simulate("75", "next.csv");
  write_minute_file(path("first.csv"),
                    until(read_minute_file(path("next.csv")), "2023-01-31T23:00:00Z"), "");
  EXPECT_THAT(begun({}).output, Names("[train] context --day-ahead"));
  ASSERT_EQ(begun({"--day-ahead", path("outlook.csv")}).exit_code, 0);
  EXPECT_THAT(refresh("next.csv").output, Names("--day-ahead"));
  std::vector<std::string> words = command("next.csv", false);
  words.insert(words.end(), {"--day-ahead", path("outlook.csv")});
  EXPECT_THAT(run(words).output, Names("21600"));
  fs::remove(path("outlook.csv"));  // it is a separate run: nothing outside it is needed
  fs::remove(path("next.csv"));
  const auto trained = fs::last_write_time(path("site.proposal/teacher.bin"));
  EXPECT_THAT(refresh("next.csv", false).output, Names("21600"));
  EXPECT_EQ(fs::last_write_time(path("site.proposal/teacher.bin")), trained);
  EXPECT_THAT(run({"runs", "compare", path("site"), path("site.proposal")}).output,
              Names("site.proposal"));
}

TEST_F(RefreshedByOutlook, FetchesWhatWasPublishedSince) {
  simulate("31", "first.csv");
  ASSERT_EQ(begun({"--day-ahead", path("outlook.csv")}).exit_code, 0);
  std::atomic<bool> is_down = true;
  const FakeElia elia([&](const EliaRequest&, EliaAnswer& answer) {
    if (is_down) answer.status = "404 Not Found";
  });
  const FakeCharts charts;
  std::vector<std::string> words{"refresh", "--run", path("site"), "--window-days", "30"};
  words.insert(words.end(), {"--accept", "shifted-day,repeated-day"});
  words.insert(words.end(), {"--base-url", elia.base_url()});
  words.insert(words.end(), {"--day-ahead-base-url", charts.base_url()});
  EXPECT_THAT(said(words, 1), Names("404"));
  is_down = false;
  said(words);
  const LocalDate yesterday = add_days(local_date_of(std::time(nullptr)), -1);
  const MinuteSeries prices = read_minute_file(path("site.proposal/market.csv.gz"));
  EXPECT_EQ(local_date_of(prices.utc_s(prices.size() - 1)), yesterday);
  EXPECT_GT(charts.requests(), 0);
}

// The benchmark's months, trained in full: minutes of two cores.
class RefreshedTwice : public RefreshCommand {};

TEST_F(RefreshedTwice, AdoptsOnRealPricesAndRefusesOnSpoiltOnes) {
  const MinuteSeries year =
      read_minute_file(BESS_SOURCE_DIR "/tests/data/benchmark_minutes_2023.csv.gz");
  make_run("[train]\nmethod = \"sdp\"\n", until(year, "2023-02-28T23:00:00Z"));
  const auto first = contents(path("site"));
  write_minute_file(path("march.csv"), until(year, "2023-03-31T22:00:00Z"), "");
  EXPECT_THAT(refresh("march.csv").output, Names("site.before-2023-03-31"));
  expect_same(path("site.before-2023-03-31"), first);
  const auto second = contents(path("site"));
  write_minute_file(path("may.csv"),
                    settled_a_day_late(until(year, "2023-05-20T22:00:00Z"), "2023-03-21T23:00:00Z",
                                       "2023-04-20T22:00:00Z"),
                    "");
  EXPECT_THAT(refresh("may.csv").output,
              testing::AllOf(Names("site.refused-2023-05-20"),
                             testing::Not(testing::HasSubstr("site.before-2023-05-20"))));
  expect_same(path("site"), second);
  EXPECT_THAT(folders(),
              testing::ElementsAre("site", "site.before-2023-03-31", "site.refused-2023-05-20"));
  EXPECT_TRUE(fs::exists(path("site.refused-2023-05-20/differing_decisions.csv")));
}

}  // namespace
}  // namespace bess
