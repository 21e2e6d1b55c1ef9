// Outlook texts: why, status.
#include <gmock/gmock.h>

#include "edge/app/program/startup.h"
#include "edge/core/control/policy.h"
#include "edge/records/log/health.h"
#include "edge/records/log/ring_log.h"
#include "edge/records/why/explanation.h"
#include "shared/local_time.h"
#include "tests/support/market_zone.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

/// Decided on a break-even price, as the loop would log it.
CycleRecord decided(std::int64_t utc_s, std::int32_t break_even_centi) {
  CycleRecord r{.utc_s = utc_s, .cycle = 1, .mode = Mode::kRunning};
  r.has_measurement = r.price.has_row = r.has_student_action = true;
  r.measurement.soc_e4 = 5'000;
  r.price.minute_utc_s = utc_s - 60;
  r.price.price_centi_eur_per_mwh = 6'000;
  r.outlook = {.source = OutlookSource::kPlanned,
               .break_even_centi = break_even_centi,
               .known_quarter_hours = 120,
               .dearest = {utc_s + 16 * 3'600, 18'020},
               .cheapest = {utc_s + 3'600, 210}};
  const LocalMinute now = local_minute_of(utc_s);
  r.context_class = student_context_class(now, break_even_centi);
  r.student_action = decide_with_student(make_lattice_state(now, r.context_class, 5'000, 6'000));
  r.reason = Reason::kStudent;
  return r;
}

class OutlookTexts : public InMarketZone, public testing::Test {
 protected:
  static std::string text_of(const CycleRecord& record) {
    Explanation explanation{.record = record, .since_utc_s = record.utc_s};
    explanation.has_margins = margins_of(record, {}, explanation.margins);
    return explanation_text(explanation, ControlSettings{});
  }
  std::int64_t noon_utc_s_ = utc_from_civil({2025, 6, 11, 13, 0, 0});  // 15:00 local
};

TEST_F(OutlookTexts, WhyNamesTheHighestAndTheLowestHourAhead) {
  EXPECT_THAT(text_of(decided(noon_utc_s_, 9'240)),
              Names("planned 92.40 EUR/MWh 07:00 180.20 16:00 2.10"));
}

TEST_F(OutlookTexts, WithoutPublishedPricesItIsWhatIsUsual) {
  CycleRecord record = decided(noon_utc_s_, 9'240);
  record.outlook.source = OutlookSource::kUsual;
  record.outlook.known_quarter_hours = 0;
  EXPECT_THAT(text_of(record), testing::AllOf(Names("usual 92.40"), testing::Not(Names("180.20"))));
}

TEST_F(OutlookTexts, ADayWithoutPublishedPricesIsATrouble) {
  RunStatus status;
  status.totals.cycles = 10;
  CycleRecord& last = status.totals.last;
  last.mode = Mode::kRunning;
  last.battery_status = last.price.status = Status::kOk;
  last.outlook.source = OutlookSource::kUsual;
  last.outlook.feed = Status::kMalformed;
  last.utc_s = 86'400;
  const HealthInputs in{.is_running = true, .status = &status, .is_of_this_run = true};
  EXPECT_EQ(assess_health(in).level, HealthLevel::kOk);
  last.utc_s = 86'520;
  const Health health = assess_health(in);
  ASSERT_EQ(health.alerts.size(), 1U);
  EXPECT_THAT(health.alerts[0].line, Names("no_day_ahead malformed"));
}

}  // namespace
}  // namespace bess
