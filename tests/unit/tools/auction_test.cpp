// Simulated auction: the published day-ahead prices over time, in the format of energy-charts, and
// the effect of each fault on a day.
#include <gmock/gmock.h>

#include <map>

#include "shared/host/json.h"
#include "tests/support/market_test_support.h"
#include "tests/support/tokens.h"
#include "tests/support/utc_of.h"
#include "tools/simulators/market_sim/auction_view.h"

namespace bess {
namespace {

using ::testing::ElementsAre;

constexpr const char* kStart = "2025-03-28T00:00:00Z";
/// 28 to 31 March 2025, local; on the 30th the clock goes forward.
constexpr const char* kFrom = "2025-03-27T23:00:00Z";
constexpr const char* kUntil = "2025-03-31T22:00:00Z";

/// Quarter-hours, or hours in quarter-hours; the price is the number of the quarter-hour, or of the
/// hour's first.
std::vector<AuctionRow> four_days(std::int64_t step_s = 900) {
  std::vector<AuctionRow> rows;
  for (std::int64_t utc_s = utc_of(kFrom); utc_s < utc_of(kUntil); utc_s += 900) {
    const auto number = static_cast<double>((utc_s / step_s * step_s - utc_of(kFrom)) / 900);
    rows.push_back({utc_s, number, step_s, 0});
  }
  return rows;
}

AuctionView with(AuctionSettings settings = {}, std::int64_t step_s = 900) {
  settings.start_utc_s = utc_of(kStart);
  return {four_days(step_s), settings};
}

struct Published {
  std::int64_t utc_s;
  double price;
  bool operator==(const Published&) const = default;
};

std::vector<Published> rows_of(const AuctionAnswer& answer) {
  const Json json = Json::parse(answer.body);
  std::vector<Published> rows;
  auto price = json.value()["price"].begin();
  for (const JsonValue second : json.value()["unix_seconds"]) {
    rows.push_back(
        {static_cast<std::int64_t>(second.number().value_or(0)), (*price).number().value_or(-1)});
    ++price;
  }
  return rows;
}

/// The local day whose prices were published on the 28th at 12:57, seen at 14:00 local.
AuctionAnswer tomorrow(const AuctionView& view, std::string_view now = "2025-03-28T13:00:00Z") {
  return view.answer("2025-03-29", "2025-03-29", utc_of(now));
}

TEST(Auction, ADayIsOutFromItsTimeOfTheDayBeforeOn) {
  const AuctionView view = with({});
  EXPECT_EQ(tomorrow(view, "2025-03-28T11:56:59Z").status, 404);
  const std::vector<Published> after = rows_of(tomorrow(view, "2025-03-28T11:57:00Z"));
  ASSERT_EQ(after.size(), 96u);
  EXPECT_EQ(after.front(), (Published{utc_of("2025-03-28T23:00:00Z"), 96}));
  EXPECT_EQ(after.back(), (Published{utc_of("2025-03-29T22:45:00Z"), 191}));
  const AuctionView later({four_days(), {.published_min = 14 * 60}});
  EXPECT_EQ(tomorrow(later, "2025-03-28T12:59:59Z").status, 404);
  EXPECT_EQ(tomorrow(later).status, 200);
}

TEST(Auction, TheFilesOwnTimeOfPublicationCounts) {
  std::vector<AuctionRow> rows = four_days();
  rows[96].published_utc_s = utc_of("2025-03-28T15:30:00Z");  // the first of the 29th
  const AuctionView view(std::move(rows), {});
  EXPECT_EQ(tomorrow(view, "2025-03-28T15:29:59Z").status, 404);
  EXPECT_EQ(rows_of(tomorrow(view, "2025-03-28T15:30:00Z")).size(), 96u);
}

TEST(Auction, AnswersInTheShapeOfEnergyCharts) {
  const AuctionAnswer answer =
      AuctionView({{utc_of(kFrom), 0, 3'600, 0}, {utc_of(kStart), 4.255, 3'600, 0}}, {})
          .answer("2025-03-28", "2025-03-28", utc_of(kStart));
  EXPECT_EQ(answer.body,
            "{\"license_info\":\"simulated by bess-sim market, no real prices\","
            "\"unix_seconds\":[1743116400,1743120000],\"price\":[0.00,4.25],"
            "\"unit\":\"EUR / MWh\",\"deprecated\":false}");
  EXPECT_EQ(answer.fault, AuctionFault::kNone);
}

TEST(Auction, ADayHasTheQuarterHoursOrHoursThatTheClockGivesIt) {
  const std::int64_t now_utc_s = utc_of("2025-03-29T13:00:00Z");
  EXPECT_EQ(rows_of(with({}).answer("2025-03-30", "2025-03-30", now_utc_s)).size(), 92u);
  EXPECT_EQ(rows_of(with({}, 3'600).answer("2025-03-30", "2025-03-30", now_utc_s)).size(), 23u);
  EXPECT_EQ(rows_of(with({}).answer("2025-03-28", "2025-04-30", now_utc_s)).size(), 284u);
}

TEST(Auction, TakesDatesAndRefusesOthers) {
  const AuctionView view = with({});
  const std::int64_t now_utc_s = utc_of("2025-03-28T13:00:00Z");
  EXPECT_EQ(rows_of(view.answer("", "", now_utc_s)).front().utc_s, utc_of(kFrom));  // today
  EXPECT_EQ(rows_of(view.answer("", "", now_utc_s)).size(), 96u);
  EXPECT_EQ(rows_of(view.answer("2025-03-29", "", now_utc_s)).size(), 96u);
  EXPECT_EQ(rows_of(view.answer("1970-01-01", "9999-12-31", now_utc_s)).size(), 192u);
  for (const char* bad : {"tomorrow", "2025-02-30", "2025-03-29T00:00:00Z", "1743116400"}) {
    EXPECT_EQ(view.answer(bad, "", now_utc_s).status, 422) << bad;
    EXPECT_THAT(view.answer("", bad, now_utc_s).body, Names("end")) << bad;
  }
}

// Each fault of a day.

TEST(AuctionFaults, EachHasANameAndSpoilsADay) {
  constexpr auto kAll = static_cast<std::size_t>(AuctionFault::kAll);
  ASSERT_EQ(std::size(kAuctionFaultNames), kAll + 1);
  for (std::size_t f = 1; f < kAll; ++f) {
    const auto fault = static_cast<AuctionFault>(f);
    const AuctionAnswer answer = tomorrow(with({.fault = fault}));
    EXPECT_EQ(answer.fault, fault);
    const bool is_told = fault == AuctionFault::kSlow || answer.body != tomorrow(with({})).body;
    EXPECT_TRUE(is_told) << kAuctionFaultNames[f];
  }
}

// Times of the faults.

/// By day of delivery, queried at the end: whether it is missing.
std::vector<bool> missing_days(const AuctionSettings& schedule,
                               std::string_view now = "2025-04-28T00:00:00Z") {
  std::vector<bool> missing;
  for (const char* day : {"2025-03-28", "2025-03-29", "2025-03-30", "2025-03-31"}) {
    missing.push_back(with(schedule).answer(day, day, utc_of(now)).status == 404);
  }
  return missing;
}

TEST(AuctionFaults, ComeAndGoByDay) {
  constexpr AuctionFault kMissing = AuctionFault::kMissing;
  // The prices of the 28th were published on the day before the start.
  EXPECT_THAT(missing_days({.fault = kMissing}), ElementsAre(false, true, true, true));
  EXPECT_THAT(missing_days({.fault = kMissing, .every = 2}),
              ElementsAre(false, false, true, false));
  // 12:57 local is 11:57 UTC on the 28th and 29th, 10:57 on the 30th.
  EXPECT_THAT(missing_days({.fault = kMissing, .from_s = 11 * 3'600 + 57 * 60 + 1}),
              ElementsAre(false, false, true, true));
  EXPECT_THAT(missing_days({.fault = kMissing, .to_s = 2 * 86'400 + 10 * 3'600 + 57 * 60}),
              ElementsAre(false, true, true, false));
}

TEST(AuctionFaults, AllComeInTurn) {
  const AuctionView view = with({.fault = AuctionFault::kAll});
  EXPECT_EQ(tomorrow(view).fault, AuctionFault::kLate);
  EXPECT_EQ(view.answer("2025-03-30", "", utc_of("2025-03-30T00:00:00Z")).fault,
            AuctionFault::kMissing);
  EXPECT_EQ(view.answer("2025-03-31", "", utc_of("2025-03-31T00:00:00Z")).fault,
            AuctionFault::kHalf);
  const AuctionView every_other = with({.fault = AuctionFault::kAll, .every = 2});
  EXPECT_EQ(every_other.answer("2025-03-30", "", utc_of("2025-03-29T13:00:00Z")).fault,
            AuctionFault::kLate);
}

// Sources of the prices.

constexpr const char* kHeader = "quarter_hour_utc,day_ahead_eur_mwh,resolution_min,published_utc\n";

TEST(AuctionRows, AreReadFromADayAheadFile) {
  const std::vector<AuctionRow> rows =
      parse_auction_rows(std::string("# provenance\n") + kHeader +
                             "2025-03-28T00:00:00Z,-3.5,60,\n"
                             "2025-03-28T01:00:00Z,4,15,2025-03-27T12:10:00Z\n",
                         "f");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].eur_per_mwh, -3.5);
  EXPECT_EQ(rows[0].step_s, 3'600);
  EXPECT_EQ(rows[0].published_utc_s, 0);
  EXPECT_EQ(rows[1].utc_s, utc_of("2025-03-28T01:00:00Z"));
  EXPECT_EQ(rows[1].step_s, 900);
  EXPECT_EQ(rows[1].published_utc_s, utc_of("2025-03-27T12:10:00Z"));
}

TEST(AuctionRows, BadOnesAreNamedWithTheirLine) {
  const std::map<std::string, std::string> cases{
      {"2025-03-28T00:07:00Z,1,60,\n", "f:2"},
      {"2025-03-28T01:00:00Z,1,60,\n2025-03-28T01:00:00Z,1,60,\n", "f:3"},
      {"2025-03-28T00:00:00Z,1,45,\n", "f:2"},
      {"2025-03-28T00:00:00Z,nan,60,\n", "f:2 day_ahead_eur_mwh nan"},
      {"2025-03-28T00:00:00Z,1,60,noon\n", "f:2 published_utc noon"},
      {"2025-03-28T00:00:00Z,1\n", "f:2 2"},
      {"", "f"}};
  for (const auto& [rows, says] : cases) {
    EXPECT_THAT(user_error_of([&, text = kHeader + rows] { parse_auction_rows(text, "f"); }),
                Names(says));
  }
  EXPECT_THAT(user_error_of([] { parse_auction_rows("minute_utc,x\n", "f"); }), Names("f:1"));
}

}  // namespace
}  // namespace bess
