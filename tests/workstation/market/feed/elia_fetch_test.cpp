// The download against a local server that answers like Elia's API, and like it on a bad day.
#include "workstation/market/feed/elia_fetch.h"

#include <gmock/gmock.h>

#include <atomic>

#include "shared/host/file.h"
#include "shared/utc_text.h"
#include "tests/support/market_test_support.h"
#include "tests/support/tokens.h"
#include "tests/workstation/market/feed/fake_elia.h"
#include "workstation/market/series/local_date.h"

namespace bess {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kNow_s = 1'750'000'000;  // 15 June 2025

class EliaFetch : public testing::Test {
 protected:
  FetchRequest request(const FakeElia& elia, const FetchSpan& span) {
    return {
        .span = span,
        .out = folder_ / "prices.csv",
        .base_url = elia.base_url(),
        .now_utc_s = kNow_s,
        .retry = {},
        .allow_gaps = true,  // most rows of a day are left out, to be quick
        .accepted = AcceptedFindings::all(),
        .sleep = [this](double seconds, const std::atomic<bool>&) { waits_.push_back(seconds); }};
  }

  static FetchedPrices described(const FetchRequest& wanted) {
    const std::atomic<bool> interrupted{false};
    return fetch_prices(wanted, interrupted).value();
  }
  static JoinedMarket fetched(const FetchRequest& wanted) { return described(wanted).market; }

  static std::size_t windows_kept(const FetchRequest& wanted) {
    std::error_code absent;
    const std::filesystem::directory_iterator files(fetch_cache_folder(wanted), absent);
    return static_cast<std::size_t>(std::distance(begin(files), end(files)));
  }

  ScratchFolder folder_;
  std::vector<double> waits_;
};

TEST_F(EliaFetch, JoinsDatasetsAcrossTheChangeOfMay2024) {
  FakeElia elia;
  const FetchRequest wanted = request(elia, {{2024, 4, 30}, {2024, 6, 2}});
  const JoinedMarket market = fetched(wanted);
  EXPECT_EQ(market.report.minutes, 34u);  // one a day
  EXPECT_EQ(market.report.quarter_hours, 34u);
  EXPECT_EQ(market.report.duplicates, 0u);
  const MinuteSeries series = read_minute_file(wanted.out);
  EXPECT_EQ(utc_text(series.start_utc_s), "2024-04-29T22:00:00Z");
  EXPECT_EQ(series.indicative.front(), 30.5);
  EXPECT_EQ(series.settled.front(), 30);
  EXPECT_EQ(series.settled.back(), 2);
  EXPECT_FALSE(std::filesystem::exists(fetch_cache_folder(wanted)));
  const std::string text = read_file(wanted.out);
  EXPECT_THAT(text, Names("Elia opendata.elia.be CC BY 4.0 ods046 ods047 ods133 ods134"));
  EXPECT_TRUE(waits_.empty());
}

TEST_F(EliaFetch, TodayComesFromTheNearRealTimeDatasets) {
  FakeElia elia;
  fetched(request(elia, {{2025, 6, 14}, {2025, 6, 15}}));
  EXPECT_THAT(elia.requests(), ElementsAre(std::pair("ods133", 1), std::pair("ods134", 1),
                                           std::pair("ods161", 1), std::pair("ods162", 1)));
}

TEST_F(EliaFetch, WaitsAsToldWhenTheQuotaIsUsedUp) {
  FakeElia elia([](const std::string& dataset, int number, httplib::Response& response) {
    if (dataset != "ods046" || number > 2) return false;
    response.status = 429;
    response.set_header(number == 1 ? "Retry-After" : "X-RateLimit-Reset", number == 1 ? "7" : "9");
    return true;
  });
  fetched(request(elia, {{2023, 1, 1}, {2023, 1, 1}}));
  EXPECT_THAT(waits_, ElementsAre(7, 9));
}

TEST_F(EliaFetch, BacksOffFromServerErrorsCutAnswersAndNonsense) {
  FakeElia elia([](const std::string& dataset, int number, httplib::Response& response) {
    if (dataset != "ods046" || number > 3) return false;
    if (number == 1) response.status = 500;
    if (number == 2) response.set_content("<html>proxy</html>\n", "text/html");
    if (number == 3) {  // announces more than it sends
      response.set_content_provider(1000, "text/csv",
                                    [](std::size_t, std::size_t, httplib::DataSink& sink) {
                                      sink.write("datetime;resol", 14);
                                      return false;
                                    });
    }
    return true;
  });
  const JoinedMarket market = fetched(request(elia, {{2023, 1, 1}, {2023, 1, 1}}));
  EXPECT_THAT(waits_, ElementsAre(1, 2, 4));
  EXPECT_EQ(market.report.minutes, 1u);
}

TEST_F(EliaFetch, GivesUpInTheEndAndGoesOnWhereItStopped) {
  std::atomic<bool> broken{true};
  FakeElia elia([&broken](const std::string& dataset, int number, httplib::Response& response) {
    if (!broken || dataset != "ods047" || number <= 1) return false;
    response.status = 502;
    return true;
  });
  const FetchRequest wanted = request(elia, {{2023, 1, 30}, {2023, 2, 3}});
  EXPECT_THAT(user_error_of([&] { fetched(wanted); }), Names("502 ods047"));
  EXPECT_FALSE(std::filesystem::exists(wanted.out));
  EXPECT_THAT(elia.requests(), ElementsAre(std::pair("ods046", 2), std::pair("ods047", 1 + 6)));
  EXPECT_THAT(waits_, ElementsAre(1, 2, 4, 8, 16));
  broken = false;
  const JoinedMarket market = fetched(wanted);
  EXPECT_EQ(market.report.minutes, 5u);
  EXPECT_EQ(market.report.quarter_hours, 5u);
  EXPECT_THAT(elia.requests(), ElementsAre(std::pair("ods046", 2), std::pair("ods047", 8)));
  EXPECT_FALSE(std::filesystem::exists(fetch_cache_folder(wanted)));
}

TEST_F(EliaFetch, ALongQuotaEndsTheRun) {
  FakeElia elia([](const std::string&, int, httplib::Response& response) {
    response.status = 429;
    response.set_header("Retry-After", "7200");
    return true;
  });
  const FetchRequest wanted = request(elia, {{2023, 1, 1}, {2023, 1, 1}});
  EXPECT_THAT(user_error_of([&] { fetched(wanted); }), Names("429 ods046 120"));
  EXPECT_TRUE(waits_.empty());
}

TEST_F(EliaFetch, AServerThatIsNotThereIsNotAskedForLong) {
  FetchRequest wanted;
  {
    const FakeElia gone;
    wanted = request(gone, {{2023, 1, 1}, {2023, 1, 1}});
  }
  EXPECT_THAT(user_error_of([&] { fetched(wanted); }), Names("3 ods046 --base-url"));
  EXPECT_THAT(waits_, ElementsAre(1, 2));
}

constexpr const char* kNoRows = "datetime;resolutioncode;imbalanceprice\n";

/// Cut, or empty, as an earlier version kept them.
TEST_F(EliaFetch, ADamagedCopyIsFetchedAgain) {
  for (const bool is_cut : {true, false}) {
    std::atomic<bool> broken{true};
    FakeElia elia([&broken](const std::string& dataset, int, httplib::Response& response) {
      if (!broken || dataset != "ods047") return false;
      response.status = 404;
      return true;
    });
    const FetchRequest wanted = request(elia, {{2023, 1, 1}, {2023, 1, 1}});
    EXPECT_THAT(user_error_of([&] { fetched(wanted); }), Names("404 ods047"));
    EXPECT_TRUE(waits_.empty());  // another try cannot mend a 404
    for (const auto& entry : std::filesystem::directory_iterator(fetch_cache_folder(wanted))) {
      if (!is_cut) write_file(entry.path(), kNoRows);
      if (is_cut) {
        std::filesystem::resize_file(entry.path(), std::filesystem::file_size(entry.path()) / 2);
      }
    }
    broken = false;
    EXPECT_EQ(fetched(wanted).report.minutes, 1u);
    EXPECT_THAT(elia.requests(), ElementsAre(std::pair("ods046", 2), std::pair("ods047", 2)));
    std::filesystem::remove(wanted.out);
  }
}

TEST_F(EliaFetch, AWindowWithoutRowsIsAskedForAgain) {
  std::atomic<bool> broken{true};
  FakeElia elia([&broken](const std::string& dataset, int, httplib::Response& response) {
    if (!broken) return false;
    if (dataset == "ods046") response.set_content(kNoRows, "text/csv");
    if (dataset == "ods047") response.status = 404;
    return true;
  });
  const FetchRequest wanted = request(elia, {{2023, 1, 1}, {2023, 1, 1}});
  EXPECT_THAT(user_error_of([&] { fetched(wanted); }), Names("404 1 ods047"));
  EXPECT_EQ(windows_kept(wanted), 0u);
  broken = false;
  EXPECT_EQ(fetched(wanted).report.minutes, 1u);
}

TEST_F(EliaFetch, DaysThatMayStillBeFillingAreNotKept) {
  FakeElia elia([](const std::string& dataset, int number, httplib::Response& response) {
    if (dataset != "ods134" || number == 1) return false;
    response.status = 404;
    return true;
  });
  const FetchRequest wanted = request(elia, {{2025, 6, 10}, {2025, 6, 14}});
  EXPECT_THAT(user_error_of([&] { fetched(wanted); }), Names("404"));
  EXPECT_EQ(windows_kept(wanted), 2u);  // 10 to 12 June; not ods133 of the 13th and 14th
}

TEST_F(EliaFetch, WithoutAnyPriceNothingIsKept) {
  FakeElia elia([](const std::string&, int, httplib::Response& response) {
    response.set_content(kNoRows, "text/csv");
    return true;
  });
  const FetchRequest wanted = request(elia, {{2023, 1, 1}, {2023, 1, 1}});
  write_file(fetch_cache_folder(wanted) / "of_another_version.csv.gz", kNoRows);
  EXPECT_THAT(user_error_of([&] { fetched(wanted); }), Names("127.0.0.1 2023-01-01"));
  EXPECT_FALSE(std::filesystem::exists(wanted.out));
  EXPECT_FALSE(std::filesystem::exists(fetch_cache_folder(wanted)));
}

TEST_F(EliaFetch, YesterdayMayNotBePublishedYet) {
  FakeElia elia([](const std::string& dataset, int, httplib::Response& response) {
    if (dataset != "ods133" && dataset != "ods134") return false;
    response.set_content(kNoRows, "text/csv");
    return true;
  });
  EXPECT_THAT(user_error_of([&] {
                fetched(request(elia, {{2025, 6, 14}, {2025, 6, 14}}));
              }),
              Names("127.0.0.1 ods133"));
  const std::string text = described(request(elia, {{2025, 6, 14}, {2025, 6, 15}})).description;
  EXPECT_THAT(text, Names("ods134 2025-06-13T22:00:00Z 2025-06-14T22:00:00Z"));
}

TEST_F(EliaFetch, AnEmptyAnswerIsAnEmptyWindow) {
  std::atomic<bool> broken{true};
  FakeElia elia([&broken](const std::string& dataset, int number, httplib::Response& response) {
    if (dataset == "ods046" && number == 1) {
      response.set_content("", "text/csv");
    } else if (broken && dataset == "ods047" && number == 2) {
      response.status = 404;
    } else {
      return false;
    }
    return true;
  });
  const FetchRequest wanted = request(elia, {{2023, 1, 31}, {2023, 2, 1}});
  EXPECT_THAT(user_error_of([&] { fetched(wanted); }), Names("404"));
  EXPECT_EQ(windows_kept(wanted), 2u);
  broken = false;
  EXPECT_EQ(fetched(wanted).report.minutes, 2u);
}

TEST_F(EliaFetch, AnEmptyWindowIsReported) {
  FakeElia elia([](const std::string& dataset, int number, httplib::Response& response) {
    if (dataset != "ods046" || number > 1) return false;
    response.set_content("", "text/csv");
    return true;
  });
  const FetchedPrices prices = described(request(elia, {{2023, 1, 31}, {2023, 2, 1}}));
  EXPECT_EQ(prices.market.report.minutes, 1u);
  EXPECT_THAT(prices.description, Names("ods046 2023-01-30T23:00:00Z 2023-01-31T23:00:00Z"));
  EXPECT_TRUE(waits_.empty());
}

TEST_F(EliaFetch, WhatHasNotEndedIsDropped) {
  FakeElia elia({}, FakeRows::kAll);
  const FetchedPrices prices = described(request(elia, {{2025, 6, 15}, {2025, 6, 15}}));
  // kNow_s is 15:06:40Z: 17 h 6 min since local midnight, of 24 h
  EXPECT_EQ(prices.market.report.minutes, 17u * 60 + 6);
  EXPECT_EQ(prices.market.report.quarter_hours, 17u * 4);
  EXPECT_THAT(prices.description, Names(std::to_string(1440 - 1026 + 96 - 68)));
}

TEST_F(EliaFetch, HeadersOfARedirectSayNothingOfTheAnswer) {
  const std::string row = "2022-12-31T23:00:00Z;PT1M;12";
  FakeElia elia([&row](const std::string& dataset, int number, httplib::Response& response) {
    if (dataset != "ods046" || number > 4) return false;
    if (number % 2 == 1) {
      response.status = 302;
      response.set_header("Location", "?hop");
      response.set_header("Retry-After", "500");
      response.set_content("moved", "text/plain");  // with its length
    } else if (number == 2) {
      response.status = 503;
    } else {  // without a length, and its last line is cut
      response.set_content_provider("text/csv", [&row](std::size_t, httplib::DataSink& sink) {
        const std::string text = kNoRows + row;
        sink.write(text.data(), text.size());
        sink.done();
        return true;
      });
    }
    return true;
  });
  fetched(request(elia, {{2023, 1, 1}, {2023, 1, 1}}));
  EXPECT_THAT(waits_, ElementsAre(1, 2));
}

TEST_F(EliaFetch, TheServersWordsAreOneQuietLine) {
  FakeElia elia([](const std::string&, int, httplib::Response& response) {
    response.status = 400;
    response.set_content(
        "{\"message\":\"bad\x1b[31m where\n second line\"}" + std::string(500, 'x'),
        "application/json");
    return true;
  });
  const std::string text = user_error_of([&] {
    fetched(request(elia, {{2023, 1, 1}, {2023, 1, 1}}));
  });
  EXPECT_THAT(text, HasSubstr("400: {\"message\":\"bad [31m where second line"));
  EXPECT_THAT(text, testing::Not(HasSubstr(std::string(200, 'x'))));
}

}  // namespace
}  // namespace bess
