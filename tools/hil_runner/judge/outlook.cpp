#include <cmath>
#include <memory>

#include "edge/control/policy.h"
#include "shared/outlook/outlook_plan.h"
#include "tools/hil_runner/judge/bench.h"
#include "tools/hil_runner/scenario/day_ahead.h"

namespace bess {
namespace {

struct MadePlan {
  OutlookPlan plan;
  OutlookDays days;
  std::int32_t level_centi = INT32_MIN;

  std::int32_t break_even_centi(const CycleRecord& cycle, const OutlookDays& known) {
    const std::int32_t now_centi = cycle.price_level.centi_eur_per_mwh();
    const std::int32_t planned_centi = planned_level_centi(now_centi);
    if (planned_centi != level_centi || !(known == days)) {
      plan.make(*student_outlook(), known, planned_centi);
      level_centi = planned_centi;
      days = known;
    }
    return plan.break_even_centi(*student_outlook(), cycle.utc_s, cycle.measurement.soc_e4,
                                 now_centi);
  }
};

void add_known(const std::vector<AuctionRow>& rows, std::int64_t from, std::int64_t until,
               OutlookDays& days) {
  for (const AuctionRow& row : rows) {
    if (row.utc_s < from || row.utc_s >= until) continue;
    days.day_ahead_centi[days.index_of(row.utc_s)] =
        static_cast<std::int32_t>(std::lround(100 * row.eur_per_mwh));
  }
}

}  // namespace

/// The plan of each decision again, by the auction's true rows, of which so many ahead were known
/// as the log says, without a hole: of tomorrow none before 13:00 local time.
void judge_outlook(Bench& bench) {
  if (student_outlook() == nullptr) return;
  const std::vector<AuctionRow> rows = day_ahead_rows(bench.scenario);
  const auto made = std::make_unique<MadePlan>();
  std::int64_t planned_day_utc_s = 0;  ///< midnight of the last day that was known
  for (const CycleRecord& cycle : bench.evidence.log) {
    const OutlookReport& seen = cycle.outlook;
    const bool is_planned = seen.source == OutlookSource::kPlanned;
    if (!is_planned && seen.source != OutlookSource::kUsual) continue;
    OutlookDays days = outlook_days_around(cycle.utc_s);
    if (is_planned) planned_day_utc_s = days.today_utc_s;
    const std::int64_t first =
        is_planned ? cycle.utc_s - cycle.utc_s % kSecondsPerQuarterHour : days.tomorrow_utc_s;
    const std::int64_t until = first + kSecondsPerQuarterHour * seen.known_quarter_hours;
    if (until > days.tomorrow_utc_s && local_minute_of(cycle.utc_s).minute_of_day < 13 * 60)
      bench.find(cycle.utc_s * kSecondNs, "nothing of tomorrow known before 13:00", "some of it");
    if (planned_day_utc_s == days.yesterday_utc_s)
      add_known(rows, days.yesterday_utc_s, days.today_utc_s, days);
    add_known(rows, is_planned ? days.today_utc_s : first, until, days);
    const std::int32_t centi = made->break_even_centi(cycle, days);
    if (centi == seen.break_even_centi) continue;
    bench.find(cycle.utc_s * kSecondNs, fmt::format("break-even at {:.2f} EUR/MWh", centi / 100.0),
               fmt::format("{:.2f}", seen.break_even_centi / 100.0));
  }
}

}  // namespace bess
