// Simulated auction and the fetch program of the real one: `bess-train prices fetch --day-ahead`
// gets the contents of bess-sim market's file, and reports each detectable fault.
#include <gmock/gmock.h>

#include <map>
#include <thread>

#include "tests/support/tokens.h"
#include "tests/support/train_commands.h"
#include "tools/simulators/market_sim/market_server.h"
#include "tools/simulators/site/site_programs.h"
#include "workstation/data/market/feed/elia_fetch.h"
#include "workstation/data/market/series/day_ahead.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {
namespace {

/// 28 and 29 March 2025, local: the second day is published when the market starts.
constexpr LocalDate kToday{2025, 3, 28}, kTomorrow{2025, 3, 29};
constexpr std::int64_t kStartS = 1'743'163'200;  // 2025-03-28T12:00:00Z

DayAheadSeries two_days() {
  DayAheadSeries series;
  for (std::int64_t utc_s = local_midnight_utc_s(kToday);
       utc_s < local_midnight_utc_s(add_days(kTomorrow, 1)); utc_s += 900) {
    const bool is_tomorrow = utc_s >= local_midnight_utc_s(kTomorrow);
    const double price = static_cast<double>(utc_s / 900 % 137) - 20.5;
    append_day_ahead(series, {utc_s, price, 15, is_tomorrow ? kStartS : 0});
  }
  return series;
}

constexpr const char* kMinutes =
    "minute_utc,indicative_eur_mwh,settled_eur_mwh\n2025-03-28T12:00:00Z,40,40\n";

class FetchFromSimulatedAuction : public TrainCommands {
 protected:
  FetchFromSimulatedAuction() {
    write_day_ahead_file(path("da.csv"), two_days(), "made for a test");
    write_file(path("minutes.csv"), kMinutes);
  }
  /// From a market that has just started.
  Result fetch(const std::vector<std::string>& more = {}) {
    SitePrograms site(BESS_SIM_PROGRAM, path(""));
    site.clock = {.anchor_utc_s = kStartS};
    site.start_market(
        joined({"--prices", path("minutes.csv"), "--day-ahead", path("da.csv")}, more));
    return fetch_from(site.market_port);
  }
  Result fetch_from(int port) {
    std::filesystem::remove(path("got.csv"));
    return run({"prices", "fetch", "--day-ahead", "--from", format_local_date(kToday), "--to",
                format_local_date(kTomorrow), "--base-url",
                "http://127.0.0.1:" + std::to_string(port), "--out", path("got.csv")});
  }
  [[nodiscard]] DayAheadSeries got() const {
    return parse_day_ahead_csv(read_file(path("got.csv")), "got.csv");
  }
};

TEST_F(FetchFromSimulatedAuction, RefusesWhatFaultsLeaveOfADay) {
  const std::map<std::string, std::string> refused{
      {"late", "2025-03-28"},        {"missing", "2025-03-28"},
      {"half", "48 96 2025-03-29"},  {"shifted-hour", "92 96 2025-03-29"},
      {"shifted-day", "2025-03-28"}, {"doubled", "2025-03"},
      {"yesterday", "2025-03-29"},   {"out-of-range", "150000"},
      {"html", "energy-charts"}};
  EXPECT_EQ(refused.size() + 2, std::size(kAuctionFaultNames) - 2);  // hours, slow: below
  for (const auto& [fault, says] : refused) {
    const Result result = fetch({"--day-ahead-fault", fault});
    EXPECT_EQ(result.exit_code, 1) << fault << result.output;
    EXPECT_THAT(result.output, Names(says)) << fault;
    EXPECT_FALSE(std::filesystem::exists(path("got.csv"))) << fault;
  }
}

TEST_F(FetchFromSimulatedAuction, OptionsSayWhichDaysAreStruck) {
  const std::vector<std::string> missing{"--day-ahead-fault", "missing"};
  const std::pair<std::vector<std::string>, bool> cases[] = {
      {{"--day-ahead-fault-every", "2"}, false},  // the second day would be published
      {{"--day-ahead-fault-from-s", "60"}, false},
      {{"--day-ahead-fault-to-s", "60"}, true},
      {{"--day-ahead-repair-s", "0"}, false},
      {{"--day-ahead-repair-s", "3600"}, true}};
  for (const auto& [more, is_missing] : cases) {
    EXPECT_EQ(fetch(joined(missing, more)).exit_code, is_missing ? 1 : 0) << more[0];
  }
}

TEST_F(FetchFromSimulatedAuction, ADayComesWhenTheOptionSays) {
  DayAheadSeries series = two_days();
  series.published_utc_s.assign(series.size(), 0);
  write_day_ahead_file(path("da.csv"), series, "made for a test");
  EXPECT_EQ(fetch().exit_code, 0);  // started at 13:00 local, after the usual 12:57
  EXPECT_EQ(fetch({"--day-ahead-at", "13:00"}).exit_code, 0);
  EXPECT_THAT(fetch({"--day-ahead-at", "13:30"}).output, Names("2025-03-28"));
}

TEST_F(FetchFromSimulatedAuction, TakesRepeatedHoursAsHours) {
  const Result hours = fetch({"--day-ahead-fault", "hours"});
  ASSERT_EQ(hours.exit_code, 0) << hours.output;
  EXPECT_THAT(hours.output, Names("24"));
  EXPECT_EQ(got().resolution_min[96 + 50], 60);
  EXPECT_EQ(got().eur_per_mwh[96 + 51], two_days().eur_per_mwh[96 + 48]);
}

TEST_F(FetchFromSimulatedAuction, ASlowServerTimesOutAndStillStops) {
  const AuctionView auction(parse_auction_rows(read_file(path("da.csv")), "da.csv"),
                            {.start_utc_s = kStartS, .fault = AuctionFault::kSlow});
  const MarketView view(parse_minute_csv(kMinutes, "minutes"), 0);
  const ScaledClock clock{.anchor_monotonic_ns = clock_ns(CLOCK_MONOTONIC),
                          .anchor_utc_s = kStartS};
  MarketServerSettings settings;
  settings.port = 0;
  MarketServer server(settings, view, clock, &auction);
  std::thread serving([&server] { server.run(); });
  const std::string url = "http://127.0.0.1:" + std::to_string(server.port()) + "/price?bzn=BE";
  const std::atomic<bool> interrupted{false};
  const HttpLimits limits{.deadline_s = 5};
  EXPECT_EQ(http_get(url + "&start=2025-03-28", interrupted, limits).kind,
            HttpOutcome::Kind::kDone);
  EXPECT_EQ(http_get(url + "&start=2025-03-29", interrupted, {.deadline_s = 1}).kind,
            HttpOutcome::Kind::kSlow);
  EXPECT_EQ(server.faults(), 1);
  server.stop();
  serving.join();
}

TEST_F(FetchFromSimulatedAuction, ASitesMarketHasThemToo) {
  ChildProcess site({BESS_SIM_PROGRAM, "site", "--folder", path("site"), "--prices",
                     path("minutes.csv"), "--day-ahead", path("da.csv"), "--map",
                     BESS_SOURCE_DIR "/edge/device/maps/alphaess.toml", "--utc-start",
                     "2025-03-28T12:05:00Z", "--set", "outlook.allow_http=true"});
  const std::string line = site.read_line();
  const std::string host = "127.0.0.1:";  // of the battery, then of the market
  ASSERT_THAT(line, ::testing::HasSubstr(host));
  const int port = std::stoi(line.substr(line.rfind(host) + host.size()));
  const Result result = fetch_from(port);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(got().eur_per_mwh, two_days().eur_per_mwh);
  EXPECT_THAT(read_file(path("site/edge.toml")),
              Names("[outlook] allow_http = true \"http://127.0.0.1:" + std::to_string(port) +
                    "/price?bzn=BE\""));
  EXPECT_EQ(SitePrograms::stop(site), 0);
}

}  // namespace
}  // namespace bess
