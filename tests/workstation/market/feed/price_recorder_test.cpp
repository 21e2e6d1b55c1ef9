// The recorder against a local server that behaves like Elia's near-real-time data sets on good and
// bad days. Time is the test's own: each pause of the recorder is one step of the script.
#include "workstation/market/feed/price_recorder.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>

#include <cstring>
#include <fstream>

#include "shared/host/child_process.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "tests/support/market_test_support.h"
#include "tests/support/tokens.h"
#include "tests/workstation/market/feed/live_elia.h"
#include "workstation/market/feed/market_files.h"
#include "workstation/market/feed/recording_folder.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using Kind = RecorderEvent::Kind;

std::int64_t utc(std::string_view text) {
  std::int64_t utc_s = 0;
  EXPECT_TRUE(parse_utc(text, utc_s)) << text;
  return utc_s;
}

constexpr double kNull = std::numeric_limits<double>::quiet_NaN();
/// Noon of a local summer day.
const std::int64_t kNoon_s = utc("2025-06-15T10:00:00Z");

class PriceRecorder : public testing::Test {
 protected:
  /// One script step for each pause of the recorder, at the end of which `pause` seconds have
  /// passed; the recorder looks once more after the last one.
  using Script = std::vector<std::function<void()>>;

  RecordSummary record(const Script& script) {
    std::size_t step = 0;
    std::atomic<bool> interrupted{false};
    return record_prices({.folder = folder(),
                          .base_url = base_url_.empty() ? elia_.base_url() : base_url_,
                          .poll_s = 20,
                          .deadline_s = deadline_s_,
                          .until_utc_s = {},
                          .clock = {.utc_s = [this] { return now_s_; },
                                    .steady_s = [this] { return static_cast<double>(now_s_); },
                                    .sleep =
                                        [&](double seconds, std::atomic<bool> const&) {
                                          pauses_.push_back(seconds);
                                          now_s_ += static_cast<std::int64_t>(seconds);
                                          if (step == script.size()) {
                                            interrupted = true;
                                          } else {
                                            script[step++]();
                                          }
                                        }},
                          .tell = [this](const RecorderEvent& event) { events_.push_back(event); }},
                         interrupted);
  }

  [[nodiscard]] fs::path folder() const { return scratch_ / "recorded"; }
  [[nodiscard]] fs::path file(const std::string& day) const { return folder() / (day + ".csv"); }
  /// The lines of a day without its head.
  [[nodiscard]] std::vector<std::string> lines(const std::string& day) const {
    const std::string contents = read_file(file(day));
    std::string_view text = contents;
    std::vector<std::string> all;
    while (!text.empty()) {
      const std::string line(take_line(text));
      if (line.starts_with("20")) all.push_back(line);
    }
    return all;
  }
  std::vector<std::string> told(Kind kind) const {
    std::vector<std::string> texts;
    for (const RecorderEvent& event : events_) {
      if (event.kind == kind) texts.push_back(event.subject + ": " + event.text);
    }
    return texts;
  }

  LiveElia elia_;
  std::string base_url_;
  ScratchFolder scratch_;
  std::int64_t now_s_ = kNoon_s;
  double deadline_s_ = 10;  ///< of a request; a loaded machine must not cost a look
  std::vector<double> pauses_;
  std::vector<RecorderEvent> events_;
};

TEST_F(PriceRecorder, WritesEachRowWithItsArrival) {
  elia_.publish(kNoon_s - 120, 50.5, -100.25);
  const RecordSummary summary = record({
      [] {},
      [this] { elia_.publish(kNoon_s - 60, 60, -20); },
      [this] { elia_.publish_price(kNoon_s, kNull); },
      [this] { elia_.publish_imbalance(kNoon_s, 7); },
      [] {},
  });
  EXPECT_THAT(
      lines("2025-06-15"),
      ElementsAre(
          "2025-06-15T09:58:00Z,50.5,-100.25,2025-06-15T10:00:00Z,2025-06-15T10:00:00Z,DataIssue,"
          "found",
          "2025-06-15T09:59:00Z,60,-20,2025-06-15T10:00:40Z,2025-06-15T10:00:40Z,DataIssue,seen",
          "2025-06-15T10:00:00Z,,,2025-06-15T10:01:00Z,,DataIssue,seen",
          "2025-06-15T10:00:00Z,,7,,2025-06-15T10:01:20Z,,seen"));
  EXPECT_EQ(summary.lines, 4u);
  EXPECT_EQ(summary.prices, 2u);
  EXPECT_EQ(summary.imbalances, 3u);
  EXPECT_EQ(summary.lateness.seen, 1u);
  EXPECT_EQ(summary.lateness.found, 1u);
  EXPECT_EQ(summary.lateness.median_s, 40);
  EXPECT_THAT(pauses_, testing::Each(20));
  EXPECT_THAT(read_file(file("2025-06-15")),
              Names("Elia opendata.elia.be CC BY 4.0 1440 " + std::string(elia_.base_url())));
}

TEST_F(PriceRecorder, ARevisionIsAFurtherLineAndTheFirstPriceCounts) {
  elia_.publish(kNoon_s - 120, kNull, 5);
  const RecordSummary summary = record({
      [this] { elia_.publish_price(kNoon_s - 120, 80); },
      [this] { elia_.publish_price(kNoon_s - 120, 90); },
      [this] { elia_.publish_price(kNoon_s - 120, 90, "NotValidated"); },
      [this] { elia_.publish_imbalance(kNoon_s - 120, 6); },
      [] {},
  });
  EXPECT_EQ(lines("2025-06-15").size(), 5u);
  EXPECT_EQ(summary.prices, 1u);
  EXPECT_EQ(summary.revised, 2u);
  const MarketRows rows = read_market_files({file("2025-06-15").string()});
  ASSERT_EQ(rows.minutes.size(), 1u);
  EXPECT_EQ(rows.minutes[0].indicative_eur_per_mwh, 80);
  EXPECT_EQ(rows.sources, std::set{MarketSource::kElia});
}

TEST_F(PriceRecorder, TakesWhatTheSourceHasOfTodayAndNothingTwice) {
  const std::int64_t midnight_s = utc("2025-06-14T22:00:00Z");
  for (std::int64_t t = midnight_s; t < kNoon_s; t += 60) elia_.publish(t, 1, 2);
  EXPECT_EQ(record({}).prices, 720u);
  EXPECT_EQ(lines("2025-06-15").size(), 720u);
  now_s_ += 7200;
  for (std::int64_t t = kNoon_s; t + 60 <= now_s_; t += 60) elia_.publish(t, 3, 4);
  const RecordSummary again = record({[] {}});
  EXPECT_EQ(again.prices, 120u);
  EXPECT_EQ(again.lateness.seen, 0u) << "rows that were there already flatter no figure";
  EXPECT_EQ(again.lateness.found, 120u);
  EXPECT_EQ(lines("2025-06-15").size(), 840u);
  EXPECT_EQ(read_market_files({file("2025-06-15").string()}).minutes.size(), 840u);
}

TEST_F(PriceRecorder, AnOutageIsToldOnceAndCaughtUp) {
  elia_.publish(kNoon_s - 60, 1, 2);
  Script script(10, [] {});
  script.front() = [this] {
    elia_.set_fault([](const std::string&, httplib::Response& response) {
      response.status = 500;
      return true;
    });
  };
  script[8] = [this] {
    elia_.set_fault({});
    for (std::int64_t t = kNoon_s; t + 60 <= now_s_; t += 60) elia_.publish(t, 3, 4);
  };
  const RecordSummary summary = record(script);
  EXPECT_THAT(told(Kind::kOutage), ElementsAre(Names("ods161 500"), Names("ods169 500")));
  EXPECT_THAT(told(Kind::kOver), ElementsAre(Names("ods161 1500 s 25"), Names("ods169 1500 s 25")));
  EXPECT_THAT(pauses_, testing::Contains(300)) << "backs off, and no further";
  EXPECT_EQ(summary.prices, lines("2025-06-15").size());
  EXPECT_GT(summary.prices, 15u);
  EXPECT_EQ(summary.lateness.seen, 0u) << "nobody looked when they arrived";
  EXPECT_EQ(summary.trouble, "");
}

TEST_F(PriceRecorder, AnOutageLongerThanALookIsCaughtUpByPaging) {
  const std::int64_t midnight_s = utc("2025-06-14T22:00:00Z");
  elia_.publish(midnight_s, 1, 2);
  now_s_ = midnight_s + 60;
  const RecordSummary summary = record({[this, midnight_s] {
    now_s_ += 5 * 3600;
    for (std::int64_t t = midnight_s; t + 60 <= now_s_; t += 60) elia_.publish(t, 1, 2);
  }});
  EXPECT_EQ(summary.prices, 301u);
}

TEST_F(PriceRecorder, WaitsAsToldFor429) {
  elia_.set_fault([](const std::string&, httplib::Response& response) {
    response.status = 429;
    response.set_header("Retry-After", "1800");
    return true;
  });
  record({[this] {
    elia_.set_fault({});
    elia_.publish(kNoon_s, 1, 2);
  }});
  EXPECT_EQ(pauses_.front(), 1800);
  EXPECT_THAT(told(Kind::kOutage), ElementsAre(Names("ods161 429 1800 s")))
      << "the other data set is left alone too";
  EXPECT_EQ(lines("2025-06-15").size(), 1u);
}

TEST_F(PriceRecorder, AHangingServerCostsNoMoreThanTheDeadline) {
  deadline_s_ = 0.5;
  elia_.publish(kNoon_s - 60, 1, 2);
  elia_.set_fault([](const std::string& dataset, httplib::Response&) {
    if (dataset == "ods161") std::this_thread::sleep_for(std::chrono::seconds(2));
    return false;
  });
  const auto start = std::chrono::steady_clock::now();
  const RecordSummary summary = record({});
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(1900));
  EXPECT_THAT(told(Kind::kOutage), ElementsAre(Names("ods161 0.5 s")));
  EXPECT_EQ(summary.prices, 0u);
  EXPECT_EQ(summary.imbalances, 1u) << "the other one is recorded all the same";
  EXPECT_FALSE(summary.answered);
}

TEST_F(PriceRecorder, NonsenseIsAnOutage) {
  elia_.set_fault([](const std::string&, httplib::Response& response) {
    response.set_content("<html>maintenance</html>", "text/html");
    return true;
  });
  record({});
  EXPECT_THAT(told(Kind::kOutage), ElementsAre(Names("ods161 JSON"), Names("ods169 JSON")));
}

TEST_F(PriceRecorder, AServerWithoutImbalancesIsRecordedWithoutThem) {
  elia_.set_fault([](const std::string& dataset, httplib::Response& response) {
    if (dataset == "ods161") return false;
    response.status = 404;
    return true;
  });
  elia_.publish(kNoon_s - 60, 1, 2);
  EXPECT_EQ(record({[] {}, [] {}}).prices, 1u);
  EXPECT_THAT(told(Kind::kOutage), ElementsAre(Names("ods169 404")));
}

TEST_F(PriceRecorder, AServerWithoutPricesIsAnErrorAtTheStartAlone) {
  const auto gone = [](const std::string&, httplib::Response& response) {
    response.status = 404;
    return true;
  };
  elia_.set_fault(gone);
  EXPECT_THAT(user_error_of([this] { record({}); }), Names("ods161 404 --url"));
  elia_.set_fault({});
  elia_.publish(kNoon_s - 60, 1, 2);
  EXPECT_EQ(record({[&] { elia_.set_fault(gone); }, [] {}, [this] { elia_.set_fault({}); }, [] {}})
                .prices,
            1u);
  EXPECT_EQ(told(Kind::kOver).size(), 2u);
}

TEST_F(PriceRecorder, ANetworkThatIsNotThereYetIsWaitedFor) {
  {
    const LiveElia gone;
    base_url_ = gone.base_url();
  }
  const RecordSummary summary = record({[] {}});
  EXPECT_THAT(told(Kind::kOutage), ElementsAre(Names("ods161")));
  EXPECT_FALSE(summary.answered);
  EXPECT_THAT(summary.trouble, Not(IsEmpty()));
}

TEST_F(PriceRecorder, DaysChangeAtLocalMidnightAndHaveTheMinutesTheyHave) {
  struct Case {
    const char* day;
    const char* next;
    const char* midnight_utc;
    const char* end_utc;
    std::size_t minutes;
  };
  for (const Case& c :
       {Case{"2025-03-30", "2025-03-31", "2025-03-29T23:00:00Z", "2025-03-30T22:00:00Z", 1380},
        Case{"2025-06-15", "2025-06-16", "2025-06-14T22:00:00Z", "2025-06-15T22:00:00Z", 1440},
        Case{"2025-10-26", "2025-10-27", "2025-10-25T22:00:00Z", "2025-10-26T23:00:00Z", 1500}}) {
    SCOPED_TRACE(c.day);
    fs::remove_all(folder());
    events_.clear();
    const std::int64_t end_s = utc(c.end_utc);
    elia_.forget_before(utc("2030-01-01T00:00:00Z"));
    for (std::int64_t t = utc(c.midnight_utc); t < end_s - 60; t += 60) elia_.publish(t, 1, 2);
    now_s_ = end_s - 20;
    record(
        {[&] { elia_.publish(end_s - 60, 3, 4); },  // the day's last minute arrives after its end
         [&] {
           elia_.forget_before(end_s);
           elia_.publish(end_s, 5, 6);
         },
         [&] {
           now_s_ = end_s + 7200;
           for (std::int64_t t = end_s; t + 60 <= now_s_; t += 60) elia_.publish(t, 5, 6);
         }});
    EXPECT_EQ(lines(c.day).size(), c.minutes);
    EXPECT_EQ(lines(c.next).size(), 120u);
    const std::string whole = std::to_string(c.minutes);
    EXPECT_THAT(told(Kind::kDay), ElementsAre(Names(std::string(c.day) + ".csv " + whole)));
    EXPECT_THAT(read_file(file(c.day)), Names(std::string(c.day) + " " + whole));
  }
}

TEST_F(PriceRecorder, ATornLineIsCutOffWhereverItWasTornAndFetchedAgain) {
  elia_.publish(kNoon_s - 180, 1.25, -2);
  elia_.publish(kNoon_s - 120, 3, 4);
  record({[this] { elia_.publish(kNoon_s - 60, -56.75, 7); }, [] {}});
  const std::string whole = read_file(file("2025-06-15"));
  const std::size_t last = whole.rfind('\n', whole.size() - 2) + 1;
  for (std::size_t size = last; size < whole.size(); ++size) {
    for (const std::string& tail : {std::string(), std::string(100, '\0')}) {
      SCOPED_TRACE(whole.substr(last, size - last));
      std::ofstream(file("2025-06-15"), std::ios::binary) << whole.substr(0, size) << tail;
      const bool only_the_line_end = size + 1 == whole.size();
      EXPECT_EQ(read_market_files({file("2025-06-15").string()}).minutes.size(),
                only_the_line_end ? 3u : 2u);
      events_.clear();
      record({});
      EXPECT_EQ(told(Kind::kMended).size(), size == last && tail.empty() ? 0u : 1u);
      const std::vector<std::string> mended = lines("2025-06-15");
      ASSERT_EQ(mended.size(), 3u);
      EXPECT_THAT(mended[2], HasSubstr("09:59:00Z,-56.75,7,"));
      EXPECT_EQ(mended[2].ends_with("seen"), only_the_line_end);
    }
  }
}

TEST_F(PriceRecorder, AFileThatIsNoRecordedDayIsLeftAlone) {
  const std::string other = "minute_utc,indicative_eur_mwh,settled_eur_mwh\n";
  write_file(file("2025-06-15"), other);
  elia_.publish(kNoon_s - 60, 1, 2);
  EXPECT_THAT(user_error_of([this] { record({}); }), Names("2025-06-15.csv"));
  EXPECT_EQ(read_file(file("2025-06-15")), other);
}

TEST_F(PriceRecorder, AFolderHasOneRecorder) {
  const RecordingFolder first(folder(), "test", {});
  EXPECT_THAT(user_error_of([this] { record({}); }), Names(std::to_string(getpid())));
}

/// From the start, and with room for a part of a line.
TEST_F(PriceRecorder, AFullDiskIsAnErrorAndTakesNothing) {
  for (const bool has_begun : {true, false}) {
    fs::remove_all(folder());
    elia_.publish(kNoon_s - 120, 1, 2);
    if (has_begun) record({});
    const std::string before = has_begun ? read_file(file("2025-06-15")) : "";
    rlimit limit{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
    const rlimit full{has_begun ? before.size() + 10 : 0, limit.rlim_max};
    const auto handler = signal(SIGXFSZ, SIG_IGN);
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
    elia_.publish(kNoon_s - 60, 3, 4);
    const std::string error = user_error_of([this] { record({}); });
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
    signal(SIGXFSZ, handler);
    EXPECT_THAT(error, Names("2025-06-15.csv"));
    ASSERT_EQ(fs::exists(folder()), has_begun);
    if (!has_begun) continue;
    EXPECT_THAT(error, Names("1 " + std::string(std::strerror(EFBIG))));
    EXPECT_EQ(read_file(file("2025-06-15")), before);
    record({});
    EXPECT_EQ(lines("2025-06-15").size(), 2u);
  }
}

/// A lock file or an empty folder would say that something was recorded, or is.
TEST_F(PriceRecorder, WhatRecordedNothingLeavesNothing) {
  elia_.set_fault([](const std::string&, httplib::Response& response) {
    response.status = 404;
    return true;
  });
  EXPECT_THAT(user_error_of([this] { record({}); }), HasSubstr("404"));
  EXPECT_FALSE(fs::exists(folder()));
  fs::create_directories(folder());
  EXPECT_THAT(user_error_of([this] { record({}); }), HasSubstr("404"));
  EXPECT_TRUE(fs::is_empty(folder())) << "a folder that was there stays";
}

/// Half a minute off: each row is there before it can be, and is taken when it can.
TEST_F(PriceRecorder, AClockThatIsALittleSlowCostsNoRow) {
  elia_.publish(kNoon_s - 60, 1, 2);
  elia_.publish(kNoon_s - 30 - kNoon_s % 60 + 30, 3, 4);  // ends in a minute
  elia_.publish(kNoon_s + 100 * 86'400, 1, 2);
  record({[] {}, [] {}, [] {}});
  EXPECT_THAT(told(Kind::kClock),
              ElementsAre(Names("ods161 2025-09-23T10:00:00Z"), Names("ods169")));
  EXPECT_THAT(lines("2025-06-15"),
              ElementsAre("2025-06-15T09:59:00Z,1,2,2025-06-15T10:00:00Z,2025-06-15T10:00:00Z,"
                          "DataIssue,found",
                          HasSubstr("2025-06-15T10:00:00Z,3,4,2025-06-15T10:01:00Z,")));
  EXPECT_FALSE(fs::exists(file("2025-09-23"))) << "a stray date makes no file";
}

/// What came was stamped hours ahead, or this clock is hours behind: no row of it has arrived when
/// it seems.
TEST_F(PriceRecorder, ASourceAheadOfTheClockIsAnErrorAtTheStart) {
  for (int minute = 0; minute < 240; ++minute) {
    elia_.publish(kNoon_s + 7'200 - 60 * (minute + 1), minute, minute);
  }
  EXPECT_THAT(user_error_of([this] { record({[] {}}); }),
              Names("ods161 2025-06-15T11:59:00Z 2025-06-15T10:00:00Z 7200 s"));
  EXPECT_FALSE(fs::exists(file("2025-06-15")));
}

/// Later it is told as an outage; nothing of such an answer is recorded, and it goes on when they
/// agree.
TEST_F(PriceRecorder, ASourceThatJumpsAheadIsAnOutage) {
  elia_.publish(kNoon_s - 60, 1, 2);
  const RecordSummary summary = record({[this] {
                                          elia_.publish(kNoon_s - 120, 5, 6);
                                          elia_.publish(kNoon_s + 3'600, 3, 4);
                                        },
                                        [] {}, [] {}});
  EXPECT_THAT(told(Kind::kOutage),
              ElementsAre(Names("ods161 2025-06-15T11:00:00Z"), Names("ods169")));
  EXPECT_EQ(lines("2025-06-15").size(), 1u);
  EXPECT_THAT(summary.trouble, Names("2025-06-15T11:00:00Z"));
}

TEST_F(PriceRecorder, AnArrivalBeforeItsMinutesEndIsRefusedByWhoReadsTheDay) {
  elia_.publish(kNoon_s - 60, 1, 2);
  record({});
  const std::string good = read_file(file("2025-06-15"));
  EXPECT_NO_THROW(parse_recorded_rows(good, "day.csv"));
  for (const char* column : {",2025-06-15T10:00:00Z,DataIssue", ",1,2,2025-06-15T10:00:00Z"}) {
    std::string early = good;
    const std::size_t at = early.find(column);
    ASSERT_NE(at, early.npos);
    early.replace(early.find("10:00:00Z", at), 9, "09:59:59Z");
    EXPECT_THAT(user_error_of([&] { parse_recorded_rows(early, "day.csv"); }),
                Names("day.csv 2025-06-15T09:59:00Z 2025-06-15T09:59:59Z"));
  }
}

TEST_F(PriceRecorder, CtrlCAndSigtermEndTheProgramInOrder) {
  elia_.publish(kNoon_s - 60, 1.5, 2);
  for (const int number : {SIGINT, SIGTERM}) {
    for (const bool hanging : {false, true}) {
      elia_.set_fault([hanging](const std::string&, httplib::Response&) {
        if (hanging) std::this_thread::sleep_for(std::chrono::seconds(3));
        return false;
      });
      const int before = elia_.requests();
      ChildProcess program({BESS_TRAIN_PROGRAM, "prices", "record", "--out", folder().string(),
                            "--url", elia_.base_url(), "--json"});
      while (elia_.requests() < before + (hanging ? 1 : 2)) usleep(1'000);
      if (!hanging) usleep(200'000);
      program.signal(number);
      const auto start = std::chrono::steady_clock::now();
      EXPECT_EQ(program.wait(), 0);
      EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(1500));
      EXPECT_THAT(program.read_all(), HasSubstr("\"event\":\"end\""));
    }
  }
  EXPECT_EQ(lines("2025-06-15").size(), 1u);
}

}  // namespace
}  // namespace bess
