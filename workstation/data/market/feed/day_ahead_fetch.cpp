#include "workstation/data/market/feed/day_ahead_fetch.h"

#include <fmt/core.h>

#include <algorithm>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "workstation/data/market/feed/elia_window.h"
#include "workstation/data/market/series/day_ahead.h"

namespace bess {
namespace {

constexpr int kDaysOfARequest = 366;

/// One answer, with retries; nothing if interrupted.
std::optional<std::string> get_day_ahead(const DayAheadRequest& request, const std::string& url,
                                         const std::atomic<bool>& interrupted) {
  using Kind = HttpOutcome::Kind;
  int slow = 0;
  for (int attempt = 1; !interrupted; ++attempt) {
    HttpOutcome outcome = http_get(url, interrupted, request.retry.limits);
    if (outcome.kind == Kind::kDone) return std::move(outcome.body);
    if (outcome.kind == Kind::kInterrupted) break;
    slow += outcome.kind == Kind::kSlow ? 1 : 0;
    const int attempts_max = outcome.kind == Kind::kUnreachable
                                 ? request.retry.attempts_unreachable_max
                                 : request.retry.attempts_max;
    if (outcome.kind == Kind::kRefused || attempt >= attempts_max ||
        slow >= request.retry.attempts_slow_max) {
      fail("{} ({}): day-ahead prices from {}; check --base-url and the network and try again",
           outcome.reason, counted(static_cast<std::size_t>(attempt), "attempt"),
           host_of(request.base_url));
    }
    const double backoff_s = request.retry.first_wait_s * static_cast<double>(1 << (attempt - 1));
    const double wait_s = std::max(outcome.wait_s.value_or(0.0), backoff_s);
    if (wait_s > request.retry.wait_max_s) {
      fail("{}; the server asks to wait {}: day-ahead prices from {}; then try again",
           outcome.reason, describe_wait(wait_s), host_of(request.base_url));
    }
    fmt::print(stderr, "day-ahead: {}; next attempt in {:.0f} s\n", outcome.reason, wait_s);
    request.sleep(wait_s, interrupted);
  }
  return std::nullopt;
}

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
    const std::optional<std::string> answer = get_day_ahead(request, url, interrupted);
    if (!answer) return std::nullopt;
    for (const DayAheadRow& row : parse_energy_charts(*answer, host_of(request.base_url))) {
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
