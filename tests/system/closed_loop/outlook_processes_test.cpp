// bess-edge with a student by outlook built in, on a market that publishes day-ahead prices: the
// plan when they come in time, over a restart while they are missing, and the seal.
#include <gmock/gmock.h>

#include <fstream>

#include "tests/support/edge_answer.h"

namespace bess {
namespace {

constexpr std::int64_t kHour = 3'600;
constexpr std::int64_t kPublishedS = SimulatedSite::kStartS + 11 * kHour;  // 13:00 in Brussels

/// Three local days of hours, high prices in the evening.
std::string day_ahead() {
  std::ostringstream text;
  text << "quarter_hour_utc,day_ahead_eur_mwh,resolution_min,published_utc\n";
  const std::int64_t first = SimulatedSite::kStartS - 25 * kHour;
  for (std::int64_t t = first; t < SimulatedSite::kStartS + 70 * kHour; t += 900) {
    const std::int64_t hour = t / kHour;
    text << utc_text(t).view() << ',' << 50 + hour % 24 * 4 + hour / 24 % 3 << ",60,\n";
  }
  return text.str();
}

class OutlookSite : public SiteTest {
 protected:
  OutlookSite() : SiteTest(300) {
    setenv("BESS_EDGE_UNDER_TEST", BESS_OUTLOOK_EDGE, 1);
    site_.clock.anchor_utc_s = kPublishedS - 40 * 60;
    site_.start_clock();
    site_.start_battery({"--map", BESS_SOURCE_DIR "/edge/device/maps/alphaess.toml"});
  }
  enum class Publishes { kDayAhead, kNothing };
  void start_market(Publishes publishes, int port = 0) {
    std::vector<std::string> options;
    if (publishes == Publishes::kDayAhead) {
      options = {"--day-ahead", site_.folder.write("ahead.csv", day_ahead())};
    }
    site_.start_market(options, SimulatedSite::minute_prices(13 * 60), port);
  }
  void configure() {
    config_ = site_.commission();
    std::ofstream(config_, std::ios::app)
        << "[outlook]\nurl = \"http://127.0.0.1:" << site_.market_port
        << "/price?bzn=BE&start={today}&end={tomorrow}\"\n";
  }
  void run(int cycles) const {
    const ProgramOutput said = ask({"--cycles", std::to_string(cycles)});
    EXPECT_EQ(said.exit_code, 0) << said.text;
  }
  [[nodiscard]] std::vector<CsvRow> cycles() const {
    std::vector<CsvRow> rows = edge_log();
    std::erase_if(rows, [](const CsvRow& row) { return row.at("mode") != "running"; });
    return rows;
  }
  static int count(const std::vector<CsvRow>& rows, const char* source) {
    return static_cast<int>(std::ranges::count_if(
        rows, [&](const CsvRow& row) { return row.at("outlook") == source; }));
  }
};

TEST_F(OutlookSite, PlansOnTodayAndFromOneOnTomorrow) {
  start_market(Publishes::kDayAhead);
  configure();
  run(40);
  const std::vector<CsvRow> rows = cycles();
  ASSERT_GT(rows.size(), 30U);
  EXPECT_GT(count(rows, "planned"), static_cast<int>(rows.size()) * 3 / 4);
  EXPECT_EQ(count(rows, "usual"), 0);
  EXPECT_EQ(count(rows, "missing"), 0);
  int before_one = 0;
  int with_tomorrow = 0;
  for (const CsvRow& row : rows) {
    if (row.at("outlook") != "planned") continue;
    const bool knows_tomorrow = std::stoi(row.at("outlook_quarter_hours")) > 96;
    const bool is_after_one = row.at("utc") >= std::string(utc_text(kPublishedS).view());
    EXPECT_TRUE(is_after_one || !knows_tomorrow) << row.at("utc");
    // A slow machine fetches it some control cycles late; known prices stay known.
    EXPECT_TRUE(knows_tomorrow || with_tomorrow == 0) << row.at("utc");
    before_one += is_after_one ? 0 : 1;
    with_tomorrow += knows_tomorrow ? 1 : 0;
  }
  EXPECT_GT(before_one, 0);
  EXPECT_GT(with_tomorrow, 0);
}

/// Earlier prices are on disk, on the day of 92 quarter-hours too.
TEST_F(OutlookSite, OverARestartItKnowsWhatItKnew) {
  start_market(Publishes::kDayAhead);
  const int port = site_.market_port;
  configure();
  run(8);
  site_.market.reset();
  start_market(Publishes::kNothing, port);
  run(8);
  const std::vector<CsvRow> rows = cycles();
  EXPECT_EQ(rows.back().at("outlook"), "planned");
  EXPECT_EQ(rows.back().at("day_ahead_status"), "http_error");
}

TEST_F(OutlookSite, WithoutAnyItPlansOnWhatIsUsual) {
  start_market(Publishes::kNothing);
  configure();
  run(12);
  const std::vector<CsvRow> rows = cycles();
  EXPECT_GT(count(rows, "usual"), static_cast<int>(rows.size()) / 2);
  EXPECT_EQ(count(rows, "planned"), 0);
  for (const CsvRow& row : rows) EXPECT_NE(row.at("student_action"), "none") << row.at("utc");
}

}  // namespace
}  // namespace bess
