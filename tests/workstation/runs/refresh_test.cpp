// bess-train refresh, the program itself: killed at its stages it ends with the same bytes; what
// is adopted takes the run's place, what is worse does not.
#include <gmock/gmock.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <map>

#include "tests/support/small_market.h"
#include "tests/support/thorough.h"
#include "tests/support/tokens.h"
#include "tests/support/train_commands.h"
#include "tests/workstation/market/feed/fake_charts.h"
#include "tests/workstation/market/feed/fake_elia.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Its battery pays so much for every exchange that it idles: learnt and proved in seconds.
constexpr const char* kIdleProgram =
    "[costs]\nimport_adder_eur_per_mwh = 1000\nimport_percent = 100\n"
    "export_fee_eur_per_mwh = 1000\nexport_percent = 100\n"
    "[train]\nmethod = \"sdp\"\n"
    "[distil]\nepochs = 12\nlearning_rate = 0.03\n"
    "[correction]\nlow_price_eur_per_mwh = -501\nhigh_price_eur_per_mwh = 1501\n";

class RefreshCommand : public TrainCommands {
 protected:
  RefreshCommand() { setenv("SOURCE_DATE_EPOCH", "1700000000", 1); }  // or a page tells its hour

  void make_run(const std::string& config, const MinuteSeries& series) const {
    write_minute_file(path("first.csv"), series, "");
    const Result made =
        run({"run", "--prices", path("first.csv"), "--config", written("config.toml", config),
             "--threads", "2", "--out", path("site")});
    ASSERT_EQ(made.exit_code, 0) << made.output;
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
  /// Every file of a folder but the times.
  [[nodiscard]] std::map<std::string, std::string> contents(const std::string& folder) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::directory_iterator(path(folder))) {
      const std::string name = entry.path().filename().string();
      if (name != "times.json") files[name] = read_file(entry.path());
    }
    return files;
  }
  [[nodiscard]] std::vector<std::string> folders() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(path("")))
      if (entry.is_directory()) names.push_back(entry.path().filename().string());
    std::ranges::sort(names);
    return names;
  }
  void expect_same(const std::string& folder,
                   const std::map<std::string, std::string>& whole) const {
    const auto files = contents(folder);
    for (const auto& [name, text] : whole) {
      ASSERT_TRUE(files.contains(name)) << name << " is missing";
      EXPECT_TRUE(files.at(name) == text) << name << " differs";
    }
    for (const auto& [name, text] : files) EXPECT_TRUE(whole.contains(name)) << name << " is left";
  }
};

/// As soon as `file` is there, and before the next stage has got far; false when it ended before.
bool kill_once_there(const std::vector<std::string>& words, const fs::path& file) {
  ChildProcess program(words);
  while (!fs::exists(file) && !program.has_ended()) usleep(300);
  program.signal(SIGKILL);
  return program.wait() != 0;
}

TEST_F(RefreshCommand, KilledAtItsStagesEndsWithTheSameBytes) {
  EXPECT_THAT(refresh("next.csv").output, Names(path("site")));
  make_run(kIdleProgram, small_series(31));
  EXPECT_THAT(refresh("next.csv").output, Names("next.csv"));  // is not there yet
  write_minute_file(path("next.csv"), small_series(36), "");   // learnt to 25 January
  const Result early = refresh("next.csv");
  EXPECT_EQ(early.exit_code, 0);
  EXPECT_THAT(early.output, Names("2023-01-25 2023-02-05 14"));
  EXPECT_THAT(folders(), testing::ElementsAre("site"));
  write_minute_file(path("next.csv"), small_series(75), "");
  ASSERT_EQ(refresh("next.csv", false).exit_code, 0);
  const auto before = contents("site");
  const auto whole = contents("site.proposal");
  ASSERT_TRUE(whole.contains("proposal.json"));
  fs::remove_all(path("site.proposal"));

  std::vector<std::string> words = command("next.csv", true);
  words.insert(words.begin(), BESS_TRAIN_PROGRAM);
  int killed = 0;
  for (const char* stage : {"run.json", "teacher.bin", "student.json", "proposal.txt"}) {
    killed += kill_once_there(words, path("site.proposal") + "/" + stage) ? 1 : 0;
    ASSERT_TRUE(fs::exists(path("site/student.json"))) << "the run stands until it is replaced";
  }
  EXPECT_GE(killed, 2);  // the last stages are over in milliseconds
  if (fs::exists(path("site.proposal"))) {
    EXPECT_THAT(refresh("next.csv").output, Names("site.before-2023-03-16"));
  }
  expect_same("site", whole);
  expect_same("site.before-2023-03-16", before);

  // Between the two names: nothing is at the run's place, and the next call puts it there.
  fs::rename(path("site"), path("site.proposal"));
  EXPECT_EQ(refresh("next.csv").exit_code, 0);
  expect_same("site", whole);
  EXPECT_THAT(folders(), testing::ElementsAre("site", "site.before-2023-03-16"));

  // It is a run like any other, wherever it lies.
  EXPECT_EQ(run({"report", "--run", path("site")}).exit_code, 0);
  expect_same("site", whole);
}

/// A month whose settled prices were filed a day late, beside the right minutes.
MinuteSeries settled_a_day_late(const MinuteSeries& series, const char* from, const char* to) {
  MinuteSeries spoilt = series;
  std::int64_t from_utc_s = 0;
  std::int64_t to_utc_s = 0;
  parse_utc(from, from_utc_s);
  parse_utc(to, to_utc_s);
  for (std::size_t m = 1440; m < series.size(); ++m) {
    if (series.utc_s(m) < from_utc_s || series.utc_s(m) >= to_utc_s) continue;
    spoilt.settled[m] = series.settled[m - 1440];
  }
  return spoilt;
}

MinuteSeries until(MinuteSeries series, const char* end) {
  std::int64_t end_utc_s = 0;
  parse_utc(end, end_utc_s);
  const auto minutes = static_cast<std::size_t>((end_utc_s - series.start_utc_s) / 60);
  series.indicative.resize(minutes);
  series.settled.resize(minutes);
  return series;
}

// By outlook, on a simulated market with its day-ahead prices.
class RefreshedByOutlook : public RefreshCommand {};

TEST_F(RefreshedByOutlook, BringsItsDayAheadPricesAlong) {
  ASSERT_EQ(run({"prices", "simulate", "--start", "2023-01-01", "--days", "75", "--out",
                 path("all.csv"), "--day-ahead-out", path("outlook.csv")})
                .exit_code,
            0);
  const MinuteSeries all = read_minute_file(path("all.csv"));
  write_minute_file(path("next.csv"), all, "");
  std::string config = kIdleProgram;
  config.insert(config.find("[train]\n") + 8, "context = \"outlook\"\n");
  const auto begun = [&](std::vector<std::string> more) {
    std::vector<std::string> words{
        "run",   "--prices",  path("first.csv"), "--config", written("config.toml", config),
        "--out", path("site")};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  };
  write_minute_file(path("first.csv"), until(all, "2023-01-31T23:00:00Z"), "");
  EXPECT_THAT(begun({}).output, Names("[train] context --day-ahead"));
  const Result made = begun({"--day-ahead", path("outlook.csv")});
  ASSERT_EQ(made.exit_code, 0) << made.output;
  EXPECT_THAT(refresh("next.csv").output, Names("--day-ahead"));
  std::vector<std::string> words = command("next.csv", false);
  words.insert(words.end(), {"--day-ahead", path("outlook.csv")});
  EXPECT_THAT(run(words).output, Names("21600"));
  fs::remove(path("outlook.csv"));  // it is a run of its own: nothing outside it is needed
  fs::remove(path("next.csv"));
  const std::string again = refresh("next.csv", false).output;
  EXPECT_THAT(again, AllOf(Names("21600"), Not(HasSubstr("[2/6]"))));
  EXPECT_THAT(run({"runs", "compare", path("site"), path("site.proposal")}).output,
              Names("site.proposal"));
}

TEST_F(RefreshedByOutlook, FetchesWhatWasPublishedSince) {
  ASSERT_EQ(run({"prices", "simulate", "--start", "2023-01-01", "--days", "31", "--out",
                 path("first.csv"), "--day-ahead-out", path("outlook.csv")})
                .exit_code,
            0);
  std::string config = kIdleProgram;
  config.insert(config.find("[train]\n") + 8, "context = \"outlook\"\n");
  ASSERT_EQ(run({"run", "--prices", path("first.csv"), "--day-ahead", path("outlook.csv"),
                 "--config", written("config.toml", config), "--out", path("site")})
                .exit_code,
            0);
  std::atomic<bool> is_down = true;
  const FakeElia elia(
      [&](const std::string&, int, httplib::Response& response) {
        if (is_down) response.status = 404;
        return is_down.load();
      },
      FakeRows::kAll);
  const FakeCharts charts;
  const std::vector<std::string> words{"refresh",
                                       "--run",
                                       path("site"),
                                       "--window-days",
                                       "30",
                                       "--accept",
                                       "shifted-day,repeated-day",
                                       "--base-url",
                                       elia.base_url(),
                                       "--day-ahead-base-url",
                                       charts.base_url()};
  const Result without = run(words);
  EXPECT_EQ(without.exit_code, 1);
  EXPECT_THAT(without.output, Names("404"));
  is_down = false;
  const Result fetched = run(words);
  EXPECT_EQ(fetched.exit_code, 0);
  const LocalDate yesterday = add_days(local_date_of(std::time(nullptr)), -1);
  const MinuteSeries prices = read_minute_file(path("site.proposal/market.csv.gz"));
  EXPECT_EQ(local_date_of(prices.utc_s(prices.size() - 1)), yesterday);
  EXPECT_GT(charts.requests, 0);
}

// The yardstick's months, learnt in full: minutes of two cores.
class RefreshedTwice : public RefreshCommand {};

TEST_F(RefreshedTwice, AdoptsOnRealPricesAndRefusesOnSpoiltOnes) {
  const MinuteSeries year =
      read_minute_file(BESS_SOURCE_DIR "/tests/data/benchmark_minutes_2023.csv.gz");
  make_run("[train]\nmethod = \"sdp\"\n", until(year, "2023-02-28T23:00:00Z"));
  const auto first = contents("site");
  write_minute_file(path("march.csv"), until(year, "2023-03-31T22:00:00Z"), "");
  EXPECT_THAT(refresh("march.csv").output, Names("site.before-2023-03-31"));
  expect_same("site.before-2023-03-31", first);
  const auto second = contents("site");
  write_minute_file(path("may.csv"),
                    settled_a_day_late(until(year, "2023-05-20T22:00:00Z"), "2023-03-21T23:00:00Z",
                                       "2023-04-20T22:00:00Z"),
                    "");
  EXPECT_THAT(refresh("may.csv").output,
              AllOf(Names("site.refused-2023-05-20"), Not(HasSubstr("site.before-2023-05-20"))));
  expect_same("site", second);
  EXPECT_THAT(folders(),
              testing::ElementsAre("site", "site.before-2023-03-31", "site.refused-2023-05-20"));
  EXPECT_TRUE(fs::exists(path("site.refused-2023-05-20/differing_decisions.csv")));
}

}  // namespace
}  // namespace bess
