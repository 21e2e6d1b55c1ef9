// bess-prices with realistic servers: units, invalid rows, refusals, history.
#include "edge/prices/fetch/price_fetcher.h"

#include <gtest/gtest.h>
#include <netdb.h>

#include <memory>

#include "shared/host/text.h"
#include "shared/utc_text.h"
#include "tests/support/test_server.h"

namespace bess {
namespace {

class PriceSourceTest : public ::testing::Test {
 protected:
  PriceSourceTest() {
    config_->price.feed.http.url =
        FixedText<511>("http://127.0.0.1:" + std::to_string(server_.port()) + "/rows?limit=20");
  }
  static std::string row(int minutes_ago, const std::string& price) {
    const std::int64_t now = clock_ns(CLOCK_REALTIME) / kNanosecondsPerSecond / 60 * 60;
    return formatted(R"({"datetime": "%s", "imbalanceprice": %s})",
                     utc_text(now - 60 * minutes_ago).c_str(), price.c_str());
  }
  static std::string rows(const std::vector<std::string>& prices) {
    std::string text = R"({"results": [)";
    for (std::size_t i = 0; i < prices.size(); ++i) {
      text += (i == 0 ? "" : ", ") + row(static_cast<int>(i) + 1, prices[i]);
    }
    return text + "]}";
  }
  PriceReply ask() {
    UnitWatch watch;
    return ask_price(*config_, watch);
  }

  std::string body_ = "[]";
  std::string first_lines_ = "HTTP/1.1 200 OK\r\n";
  TestServer server_{[this](TestConnection& connection, const std::string&) {
    return connection.answer(body_, first_lines_);
  }};
  std::unique_ptr<EdgeConfig> config_ = std::make_unique<EdgeConfig>();
};

TEST_F(PriceSourceTest, OneBadRowAmongGoodOnesIsSkipped) {
  for (const char* bad :
       {"null", "NaN", "-Infinity", "\"42\"", "\"n/a\"", "{}", "[]", "true", "1e9", "\"NaN\""}) {
    body_ = rows({bad, "42.5", "43"});
    const PriceReply answer = ask();
    EXPECT_EQ(answer.status, Status::kOk) << bad;
    EXPECT_EQ(answer.newest.price_centi_eur_per_mwh, 4'250) << bad;
    EXPECT_EQ(answer.passed_over, 1) << bad;
  }
}

TEST_F(PriceSourceTest, UnitsAndNumbersForNone) {
  struct Case {
    std::int32_t eur_per_mwh_e1;
    const char* price;
    std::int32_t centi;
  };
  for (const Case& c : {Case{10, "85.12", 8'512}, Case{10'000, "0.08512", 8'512},
                        Case{100, "8.512", 8'512}, Case{10'000, "-0.3", -30'000}}) {
    config_->price.feed.fields.eur_per_mwh_e1 = c.eur_per_mwh_e1;
    body_ = rows({c.price});
    EXPECT_EQ(ask().newest.price_centi_eur_per_mwh, c.centi) << c.price;
  }
  config_->price.feed.fields.eur_per_mwh_e1 = 10;
  body_ = rows({"-999", "50"});
  EXPECT_EQ(ask().newest.price_centi_eur_per_mwh, -99'900) << "a real price by default";
  config_->price.feed.fields.no_price.push_back(-999);
  EXPECT_EQ(ask().newest.price_centi_eur_per_mwh, 5'000);
}

TEST_F(PriceSourceTest, AnotherUnitShowsWithTheFirstAnswer) {
  std::vector<std::string> prices;
  for (int i = 0; i < 100; ++i) prices.push_back(formatted("%.5f", 0.085 + 0.0007 * (i % 23)));
  body_ = rows(prices);
  UnitWatch watch;
  EXPECT_EQ(ask_first_price(*config_, watch).status, Status::kOk);
  EXPECT_TRUE(watch.is_doubtful());
  config_->price.feed.fields.eur_per_mwh_e1 = 10'000;
  UnitWatch right;
  EXPECT_EQ(ask_first_price(*config_, right).status, Status::kOk);
  EXPECT_FALSE(right.is_doubtful());
}

TEST_F(PriceSourceTest, ARefusalSaysForHowLong) {
  first_lines_ = "HTTP/1.1 429 Too Many Requests\r\nRetry-After: 50\r\n";
  const PriceReply answer = ask();
  EXPECT_EQ(answer.status, Status::kServerBusy);
  EXPECT_EQ(answer.wait_s, 50);
}

TEST_F(PriceSourceTest, FailuresHaveTheirStatus) {
  first_lines_ = "HTTP/1.1 500 Oh\r\n";
  EXPECT_EQ(ask().status, Status::kHttpError);
  first_lines_ = "HTTP/1.1 200 OK\r\n";
  for (const char* text : {"", "<html>", "{\"results\": 3}", "{\"rows\": []}"}) {
    body_ = text;
    EXPECT_NE(ask().status, Status::kOk) << text;
  }
  body_ = rows({"null"});
  EXPECT_EQ(ask().status, Status::kNoRow);
  config_->price.feed.http.url = "http://127.0.0.1:1/";
  EXPECT_EQ(ask().status, Status::kNotConnected);
  addrinfo* found = nullptr;
  if (getaddrinfo("no-such-host.invalid", nullptr, nullptr, &found) == 0) {
    freeaddrinfo(found);
    return;  // this resolver answers every name
  }
  config_->price.feed.http.url = "http://no-such-host.invalid/";
  EXPECT_EQ(ask().status, Status::kNameUnresolved);
}

TEST_F(PriceSourceTest, HistoryGivesALevel) {
  std::vector<std::string> prices(100, "80");
  body_ = rows(prices);
  config_->price.history.hours = 1;
  const PublishedHistory history = find_history(*config_);
  EXPECT_TRUE(history.is_done);
  EXPECT_GE(history.rows, 55);
  EXPECT_EQ(history.level.centi_eur_per_mwh(), 8'000);
  config_->price.history.hours = 0;
  EXPECT_FALSE(find_history(*config_).level.is_known());
}

}  // namespace
}  // namespace bess
