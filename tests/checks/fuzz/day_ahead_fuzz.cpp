// Day-ahead prices in all formats: ENTSO-E A44, energy-charts JSON, CSV, and the file made from
// them. Accepted input reads back identically, and no price is known before noon of the previous
// day.
#include "shared/host/user_error.h"
#include "shared/local_time.h"
#include "tests/checks/fuzz/fuzz_target.h"
#include "workstation/data/market/feed/day_ahead_rows.h"
#include "workstation/data/market/series/day_ahead.h"

namespace bess {
namespace {

void check_day_ahead(std::string_view text) {
  static const bool time_zone_set = (set_market_time_zone(), true);
  (void)time_zone_set;
  DayAheadSeries series;
  try {
    series = is_day_ahead_csv(text)
                 ? parse_day_ahead_csv(text, "fuzz")
                 : join_day_ahead(parse_day_ahead_text(text, "fuzz").rows, "fuzz").series;
  } catch (const UserError&) {
    return;
  }
  must(series.start_utc_s % kSecondsPerQuarterHour == 0, "a series starts on a quarter-hour");
  must(series.resolution_min.size() == series.size() &&
           series.published_utc_s.size() == series.size(),
       "every price has its resolution and time");
  constexpr std::size_t kQuarterHoursMax = 20'000;  // years between two rows only cost time
  if (series.size() > kQuarterHoursMax) return;
  const std::string written = format_day_ahead_csv(series, "");
  must(format_day_ahead_csv(parse_day_ahead_csv(written, "written"), "") == written,
       "what is written reads back to the same");
  const DayAheadPublication publication(series);
  for (std::size_t q = 0; q < series.size(); q += 97) {
    constexpr std::int64_t kTwoDays_s = 2 * 86'400;
    must(
        !is_published(publication.known_eur_per_mwh(series.utc_s(q), series.utc_s(q) - kTwoDays_s)),
        "nothing is known two days before");
  }
}

}  // namespace
}  // namespace bess

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  bess::check_day_ahead(bess::text_of(data, size));
  return 0;
}
