// Settled prices: rows in the format of Elia's portal, a late, failing or invalid server, and the
// resulting file.
#include "edge/prices/fetch/settled_fetch.h"

#include <gmock/gmock.h>

#include "edge/records/account/settled_prices.h"
#include "shared/local_time.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_server.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::HasSubstr;

const std::string kSettings =
    "[battery]\nmap = \"" BESS_SOURCE_DIR
    "/edge/device/maps/simulator.toml\"\n[price]\nurl = \"http://127.0.0.1:1/p\"\n";
constexpr std::int64_t kSettleNow = 1'679'911'200;       // 2023-03-27, 12:00 in Brussels
constexpr std::int64_t kSettleMidnight = 1'679'868'000;  // 22:00Z: the previous day had 23 hours

TEST(SettledRows, AreElias) {
  std::string trouble;
  const auto rows = parse_settled(
      R"([{"datetime":"2025-10-08T13:00:00+02:00","resolutioncode":"PT15M","qualitystatus":"NotValidated",
          "imbalanceprice":100.06},
         {"datetime":"2025-10-08T11:15:00+00:00","qualitystatus":"Validated","imbalanceprice":-3.5},
         {"datetime":"2025-10-08T11:30:00Z","qualitystatus":"DataIssue","imbalanceprice":null},
         {"datetime":"2023-01-01T00:00:00+01:00","qualitystatus":"Validated","positiveimbalanceprice":-11.28},
         {"datetime":"2025-10-08T11:31:00Z","imbalanceprice":1},
         {"datetime":"not a time","imbalanceprice":1}, 7])",
      trouble);
  EXPECT_EQ(trouble, "");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].eur_per_mwh, 100.06);
  EXPECT_EQ(rows[0].state, PriceState::kPublished);
  EXPECT_EQ(rows[1].start_utc_s, rows[0].start_utc_s + 900);
  EXPECT_EQ(rows[1].state, PriceState::kValidated);
  EXPECT_EQ(rows[2].eur_per_mwh, -11.28);
  EXPECT_EQ(parse_settled(R"({"total_count":0,"results":[]})", trouble).size(), 0u);
  EXPECT_EQ(trouble, "");
  for (const char* const bad : {"", "<html>", "{}", "7", R"([{"price":1}])"}) {
    std::string why;
    EXPECT_TRUE(parse_settled(bad, why).empty());
    EXPECT_NE(why, "") << bad;
  }
}

/// Late: 15 min, doubled each time, 4 h at most; complete: after midnight.
TEST(SettledSchedule, TriesAgainAndThenOnceADay) {
  set_market_time_zone();
  SettledSchedule schedule;
  EXPECT_TRUE(schedule.is_due(kSettleNow));
  std::int64_t now = kSettleNow;
  for (const int pause_s : {900, 1'800, 3'600, 7'200, 14'400, 14'400}) {
    schedule.tried(now, false);
    EXPECT_FALSE(schedule.is_due(now + pause_s - 1));
    EXPECT_TRUE(schedule.is_due(now + pause_s));
    now += pause_s;
  }
  schedule.tried(kSettleNow, true);
  EXPECT_FALSE(schedule.is_due(kSettleMidnight + 86'400 + 7'199));
  EXPECT_TRUE(schedule.is_due(kSettleMidnight + 86'400 + 7'200));
  schedule.tried(kSettleMidnight - 60, true);  // 23:59 before a day begins
  EXPECT_TRUE(schedule.is_due(kSettleMidnight + 7'200));
}

/// Query terms of Elia's portal (Opendatasoft API v2.1): instants with offset, half open.
TEST(SettledUrl, IsEliasWhereItHasNoQuery) {
  SettledSource source;
  source.url = "https://opendata.elia.be/datasets/ods134/exports/json";
  EXPECT_EQ(settled_url(source, kSettleMidnight - 900, kSettleMidnight),
            "https://opendata.elia.be/datasets/ods134/exports/json"
            "?where=datetime%20%3E%3D%20%222023-03-26T21:45:00Z%22%20AND%20datetime%20%3C%20"
            "%222023-03-26T22:00:00Z%22&select=datetime,imbalanceprice,qualitystatus&timezone=UTC");
  source.url = "https://example.org/{until}/{from}";
  EXPECT_EQ(settled_url(source, 0, 900),
            "https://example.org/1970-01-01T00:15:00Z/1970-01-01T00:00:00Z");
}

class SettledServer : public ::testing::Test {
 protected:
  SettledServer()
      : server_(
            [this](TestConnection& to, const std::string& request) {
              request_ = request;
              return to.answer(body_, first_lines_);
            },
            TestServer::Options{}) {
    set_market_time_zone();
    source_.url =
        "http://127.0.0.1:" + std::to_string(server_.port()) +
        "/exports/json?where=datetime%20%3E%3D%20%22{from}%22%20AND%20datetime%20%3C%20%22"
        "{until}%22";
    source_.file = folder_.file("state/settled.csv");
    source_.days = 1;
    source_.timeout_ms = 2'000;
  }

  /// Every quarter-hour from `from` to `until`.
  static std::string rows(std::int64_t from, std::int64_t until, double price,
                          const char* quality) {
    std::string text = "[";
    for (std::int64_t at = from; at < until; at += 900) {
      text += std::string(at == from ? "" : ",") + R"({"datetime":")" + utc_text(at).c_str() +
              R"(","qualitystatus":")" + quality + R"(","imbalanceprice":)" +
              std::to_string(price) + "}";
    }
    return text + "]";
  }
  [[nodiscard]] SettledResult fetch() const { return fetch_settled(source_, kSettleNow, {}); }
  [[nodiscard]] SettledPrices kept() const {
    SettledPrices prices;
    EXPECT_EQ(prices.read(source_.file), "");
    return prices;
  }

  const TemporaryFolder folder_;
  std::string body_ = "[]";
  std::string first_lines_ = "HTTP/1.1 200 OK\r\n";
  std::string request_;
  TestServer server_;
  SettledSource source_;
};

TEST_F(SettledServer, IsAskedForWhatIsOpenAndWhatItSaysIsKept) {
  const std::int64_t first = kSettleMidnight - 86'400;
  body_ = rows(first, kSettleMidnight, 12.5, "Not Validated");
  SettledResult result = fetch();
  EXPECT_EQ(result.trouble, "");
  EXPECT_EQ(result.fetched, 96);
  EXPECT_TRUE(result.is_whole);
  EXPECT_THAT(request_, HasSubstr("%222023-03-25T22:00:00Z%22"));
  EXPECT_THAT(request_, HasSubstr("%222023-03-26T22:00:00Z%22"));
  EXPECT_EQ(kept().quarters().size(), 96u);
  // Half of it is validated, at another price; the next request is for the other half.
  body_ = rows(first, first + 43'200, 13, "Validated");
  EXPECT_TRUE(fetch().is_whole);
  EXPECT_EQ(kept().find(first)->eur_per_mwh, 13);
  EXPECT_EQ(kept().find(first + 43'200)->eur_per_mwh, 12.5);
  EXPECT_EQ(fetch().trouble, "");
  EXPECT_THAT(request_, HasSubstr("%222023-03-26T10:00:00Z%22"));
}

TEST_F(SettledServer, MayBeLateFailOrTalkNonsense) {
  body_ = rows(kSettleMidnight - 86'400, kSettleMidnight - 900, 12.5, "NV");
  SettledResult result = fetch();
  EXPECT_EQ(result.trouble, "");
  EXPECT_FALSE(result.is_whole);
  const std::string before = text_of_file(source_.file);
  first_lines_ = "HTTP/1.1 429 Too Many Requests\r\n";
  EXPECT_THAT(fetch().trouble, Names("429"));
  first_lines_ = "HTTP/1.1 302 Found\r\nLocation: http://127.0.0.1:1/\r\n";
  const std::string redirected = fetch().trouble;
  EXPECT_NE(redirected, "");
  first_lines_ = "HTTP/1.1 200 OK\r\n";
  body_ = "<html>maintenance</html>";
  EXPECT_NE(fetch().trouble, "");
  body_ = rows(kSettleMidnight - 900, kSettleMidnight, 12.5, "NV").substr(0, 50);
  EXPECT_NE(fetch().trouble, "");
  EXPECT_EQ(text_of_file(source_.file), before);
  source_.url = "http://127.0.0.1:1/{from}{until}";
  EXPECT_EQ(fetch().trouble, redirected) << "no server listens there";
  EXPECT_EQ(text_of_file(source_.file), before);
}

TEST_F(SettledServer, ADamagedFileIsFetchedAgain) {
  body_ = rows(kSettleMidnight - 86'400, kSettleMidnight, 12.5, "Validated");
  EXPECT_EQ(fetch().trouble, "");
  const std::string whole = text_of_file(source_.file);
  EXPECT_EQ(folder_.write("state/settled.csv", whole.substr(0, 200)), source_.file);
  EXPECT_EQ(fetch().trouble, "");
  EXPECT_EQ(text_of_file(source_.file), whole);
}

/// By the program, and then by the fetcher next to the alarms.
TEST_F(SettledServer, IsAskedByTheProgram) {
  const std::int64_t now = clock_ns(CLOCK_REALTIME) / kNanosecondsPerSecond;
  const std::int64_t start = now / 900 * 900 - 96 * 900;
  body_ = rows(start, start + 900, 7, "NV");
  const std::string config =
      folder_.write("edge.toml", kSettings + "[settled]\nurl = \"" + source_.url + "\"\n");
  EXPECT_EQ(std::system((std::string(BESS_PRICES_PROGRAM) + " --settle --config " + config + " > " +
                         folder_.file("said"))
                            .c_str()),
            0);
  EXPECT_THAT(text_of_file(folder_.file("said")), Names("1"));
  EXPECT_EQ(kept().find(start)->eur_per_mwh, 7);
  std::filesystem::remove(source_.file);
  const std::jthread fetcher(
      [&](const std::stop_token& stop) { fetch_settled_daily(source_, ScaledClock{}, stop); });
  for (int i = 0; i < 500 && !std::filesystem::exists(source_.file); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_EQ(kept().find(start)->eur_per_mwh, 7);
}

TEST_F(SettledServer, KeysAreRefusedByFileAndLine) {
  const auto refused = [&](const std::string& lines) {
    const std::string config = folder_.write("bad.toml", "[settled]\n" + lines + kSettings);
    std::system((std::string(BESS_PRICES_PROGRAM) + " --check --config " + config + " > " +
                 folder_.file("said") + " 2>&1")
                    .c_str());
    return text_of_file(folder_.file("said"));
  };
  EXPECT_THAT(refused("url = \"http://example.org/{from}{until}\"\n"),
              Names("bad.toml:2 [settled] url https://"));
  for (const char* const url : {"http://localhost.evil.example/", "http://127.0.0.1@evil.example/",
                                "http://127.0.0.1.evil.example/", "ftp://127.0.0.1/"}) {
    EXPECT_THAT(refused("url = \"" + std::string(url) + "\"\n"), Names("bad.toml:2 [settled] url"));
  }
  EXPECT_THAT(refused("url = \"https://example.org/\"\nca_file = \"none.pem\"\n"),
              Names("bad.toml:3 [settled] ca_file"));
  EXPECT_THAT(refused("url = \"https://example.org/{from}\"\n"),
              Names("[settled] url {from} {until}"));
  EXPECT_THAT(refused("url = \"https://example.org/?limit=3\"\n"),
              Names("[settled] url {from} {until}"));
  EXPECT_THAT(refused("day = 3\n"), Names("bad.toml:2 day"));
  EXPECT_THAT(refused("url = \"https://example.org/{from}/{until}\"\n"), Names("settled 62"));
}

}  // namespace
}  // namespace bess
