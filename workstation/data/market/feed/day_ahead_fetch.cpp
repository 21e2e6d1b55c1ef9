#include "workstation/data/market/feed/day_ahead_fetch.h"

#include <fmt/core.h>

#include <algorithm>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "workstation/data/market/feed/elia_fetch.h"
#include "workstation/data/market/series/day_ahead.h"

namespace bess {
namespace {

constexpr int kDaysOfARequest = 366;

/// Last day whose prices must be published: tomorrow from one hour after the usual time.
LocalDate last_published_day(std::int64_t now_utc_s) {
  constexpr int kLate_min = 60;
  const bool is_out = local_minute_of(now_utc_s).minute_of_day >= kDayAheadPublishedMin + kLate_min;
  return add_days(local_date_of(now_utc_s), is_out ? 1 : 0);
}

void require_complete(const DayAheadRequest& request, const JoinedDayAhead& joined) {
  const LocalDate last = std::min(request.span.to, last_published_day(request.now_utc_s));
  const DayAheadSeries& series = joined.series;
  const std::string host = host_of(request.base_url);
  if (local_date_of(series.start_utc_s) > request.span.from ||
      local_date_of(series.end_utc_s() - 1) < last) {
    fail("{}: day-ahead prices from {} to {} only; run again later, or with --allow-gaps", host,
         format_local_date(local_date_of(series.start_utc_s)),
         format_local_date(local_date_of(series.end_utc_s() - 1)));
  }
  const std::vector<IncompleteDay> incomplete = incomplete_days(series);
  if (incomplete.empty()) return;
  fail("{}: {} of {} day-ahead prices on {}{}; run again later, or with --allow-gaps", host,
       incomplete.front().prices, incomplete.front().quarter_hours, incomplete.front().date,
       incomplete.size() == 1
           ? ""
           : fmt::format(", and {} more with gaps", counted(incomplete.size() - 1, "day")));
}

}  // namespace

std::optional<JoinedDayAhead> fetch_day_ahead(const DayAheadRequest& request,
                                              const std::atomic<bool>& interrupted) {
  if (request.span.to < request.span.from) {
    fail("--to {} is before --from {}", format_local_date(request.span.to),
         format_local_date(request.span.from));
  }
  std::vector<DayAheadRow> rows;
  for (LocalDate from = request.span.from; from <= request.span.to;) {
    const LocalDate to = std::min(request.span.to, add_days(from, kDaysOfARequest - 1));
    const std::string url =
        fmt::format("{}/price?bzn={}&start={}&end={}", request.base_url, url_encoded(request.zone),
                    format_local_date(from), format_local_date(to));
    std::string answer;
    const auto read = [&answer](std::string body) { answer = std::move(body); };
    const RetriedRequest retried{url, "day-ahead",
                                 "day-ahead prices from " + host_of(request.base_url), "try again",
                                 "then try again"};
    if (!get_with_retries(retried, request.retry, request.sleep, interrupted, read)) return {};
    for (const DayAheadRow& row : parse_energy_charts(answer, host_of(request.base_url))) {
      const LocalDate date = local_date_of(row.utc_s);
      if (date >= from && date <= to) rows.push_back(row);
    }
    from = add_days(to, 1);
  }
  JoinedDayAhead joined = join_day_ahead(std::move(rows), host_of(request.base_url));
  if (!request.allow_gaps) require_complete(request, joined);
  return joined;
}

}  // namespace bess
