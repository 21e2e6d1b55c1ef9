// The download against a local server that answers like Elia's API, and like it on a bad day.
#include "workstation/market/elia_fetch.h"

#include <gmock/gmock.h>

#include <atomic>

#include "tests/workstation/market/fake_elia.h"
#include "tests/workstation/market/market_test_support.h"
#include "workstation/io/file.h"
#include "workstation/market/local_date.h"

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
        .sleep = [this](double seconds, const std::atomic<bool>&) { waits_.push_back(seconds); }};
  }

  static JoinedMarket fetched(const FetchRequest& wanted) {
    const std::atomic<bool> interrupted{false};
    return fetch_prices(wanted, interrupted).value().market;
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
  EXPECT_EQ(format_utc(series.start_utc_s), "2024-04-29T22:00:00Z");
  EXPECT_EQ(series.indicative.front(), 30.5);
  EXPECT_EQ(series.settled.front(), 30);
  EXPECT_EQ(series.settled.back(), 2);
  EXPECT_FALSE(std::filesystem::exists(fetch_cache_folder(wanted)));
  const std::string text = read_file(wanted.out);
  EXPECT_THAT(text, HasSubstr("# Source: Elia"));
  EXPECT_THAT(text, HasSubstr("CC BY 4.0"));
  EXPECT_THAT(text, HasSubstr("ods046 ods047 ods133 ods134"));
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
    if (number == 2) response.set_content("<html>proxy</html>", "text/html");
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
  EXPECT_THAT(user_error_of([&] { fetched(wanted); }), HasSubstr("502"));
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

TEST_F(EliaFetch, ADamagedCopyIsFetchedAgain) {
  std::atomic<bool> broken{true};
  FakeElia elia([&broken](const std::string& dataset, int, httplib::Response& response) {
    if (!broken || dataset != "ods047") return false;
    response.status = 404;
    return true;
  });
  const FetchRequest wanted = request(elia, {{2023, 1, 1}, {2023, 1, 1}});
  EXPECT_THAT(user_error_of([&] { fetched(wanted); }), HasSubstr("404"));
  EXPECT_TRUE(waits_.empty());  // another try cannot mend a 404
  for (const auto& entry : std::filesystem::directory_iterator(fetch_cache_folder(wanted))) {
    std::filesystem::resize_file(entry.path(), std::filesystem::file_size(entry.path()) / 2);
  }
  broken = false;
  EXPECT_EQ(fetched(wanted).report.minutes, 1u);
  EXPECT_THAT(elia.requests(), ElementsAre(std::pair("ods046", 2), std::pair("ods047", 2)));
}

TEST_F(EliaFetch, ALongQuotaEndsTheRunWithAnExplanation) {
  FakeElia elia([](const std::string&, int, httplib::Response& response) {
    response.status = 429;
    response.set_header("Retry-After", "7200");
    return true;
  });
  EXPECT_THAT(user_error_of([&] {
                fetched(request(elia, {{2023, 1, 1}, {2023, 1, 1}}));
              }),
              HasSubstr("wait 120 minutes"));
}

TEST_F(EliaFetch, AServerThatIsNotThereIsNotAskedForLong) {
  FetchRequest wanted;
  {
    const FakeElia gone;
    wanted = request(gone, {{2023, 1, 1}, {2023, 1, 1}});
  }
  EXPECT_THAT(user_error_of([&] { fetched(wanted); }), HasSubstr("check --base-url"));
  EXPECT_THAT(waits_, ElementsAre(1, 2));
}

TEST_F(EliaFetch, AnEmptySpanIsSaidSo) {
  FakeElia elia([](const std::string&, int, httplib::Response& response) {
    response.set_content("datetime;resolutioncode;imbalanceprice\n", "text/csv");
    return true;
  });
  const FetchRequest wanted = request(elia, {{2023, 1, 1}, {2023, 1, 1}});
  EXPECT_THAT(user_error_of([&] { fetched(wanted); }), HasSubstr("holds no prices"));
  EXPECT_FALSE(std::filesystem::exists(wanted.out));
}

TEST_F(EliaFetch, ReplaysTheRealDownloads) {
  BESS_SKIP_WITHOUT("raw/ods047_head3000.csv.gz");
  FakeElia elia([](const std::string& dataset, int, httplib::Response& response) {
    if (dataset == "ods047") {
      response.set_content(read_file(real_sample("raw/ods047_head3000.csv.gz")), "text/csv");
    } else if (dataset == "ods133") {
      response.set_content(read_file(real_sample("raw/ods161_2024-09-06.csv.gz")), "text/csv");
    } else {
      response.set_content("datetime;imbalanceprice\n", "text/csv");
    }
    return true;
  });
  EXPECT_EQ(fetched(request(elia, {{2023, 4, 25}, {2023, 5, 10}})).report.quarter_hours,
            16u * 96u);  // the server ignores the window, the client does not
  const JoinedMarket september = fetched(request(elia, {{2024, 9, 6}, {2024, 9, 6}}));
  EXPECT_EQ(september.report.minutes, 1137u);
  EXPECT_TRUE(september.report.settled_from_minutes);
}

}  // namespace
}  // namespace bess
