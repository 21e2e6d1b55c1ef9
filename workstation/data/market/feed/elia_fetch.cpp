#include "workstation/data/market/feed/elia_fetch.h"

#include <fmt/core.h>

#include <algorithm>
#include <ranges>

#include "shared/crc32.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"
#include "workstation/base/progress.h"
#include "workstation/data/market/series/day_ahead.h"

namespace bess {

namespace {

/// First day of the local mFRR market and its datasets.
constexpr LocalDate kNewDatasets{2024, 5, 22};

struct DatasetPair {
  const char* minutes;
  const char* quarter_hours;
};

constexpr DatasetPair kOld{"ods046", "ods047"};
constexpr DatasetPair kNew{"ods133", "ods134"};
constexpr DatasetPair kToday{"ods161", "ods162"};

/// Datasets of the running day may be refreshed a day late.
constexpr int kFillingDays = 2;

DatasetPair datasets_of(const LocalDate& day, const LocalDate& today) {
  if (day == today) return kToday;
  return day < kNewDatasets ? kOld : kNew;
}

LocalDate next_month(const LocalDate& day) {
  return day.month == 12 ? LocalDate{day.year + 1, 1, 1} : LocalDate{day.year, day.month + 1, 1};
}

/// First day of the next window: end of month, change of datasets, incomplete days, today, or end
/// of the span.
LocalDate window_end(const LocalDate& from, const LocalDate& end, const LocalDate& today) {
  LocalDate until = std::min(end, next_month(from));
  for (const LocalDate& border : {kNewDatasets, add_days(today, -kFillingDays), today}) {
    if (from < border) until = std::min(until, border);
  }
  return until;
}

/// Dataset that is refreshed all day; the others once a day.
bool is_near_real_time(std::string_view dataset) {
  return dataset == kToday.minutes || dataset == kToday.quarter_hours;
}

namespace fs = std::filesystem;

/// The name includes the server, so that cached windows of different servers are distinct.
fs::path window_path(const FetchRequest& request, const FetchWindow& window) {
  Crc32 server;
  server.add_bytes(request.base_url.data(), request.base_url.size());
  return fetch_cache_folder(request) / fmt::format("{}_{}_{}_{:08x}.csv.gz", window.dataset,
                                                   window.from_utc_s, window.until_utc_s,
                                                   server.value());
}

/// Rows of a window from an earlier run. Damaged or empty copies are ignored, and copies with gaps
/// unless gaps are allowed: the server may have filled them.
std::optional<WindowRows> kept_rows(const FetchRequest& request, const FetchWindow& window) {
  const fs::path path = window_path(request, window);
  if (window.settles_later || !fs::exists(path)) return std::nullopt;
  try {
    WindowRows rows = rows_in_window(read_file(path), path.string(), window, request.now_utc_s);
    const bool complete = holes_in(window, rows.rows, request.now_utc_s).empty();
    if (count_of(rows.rows) > 0 && (complete || request.allow_gaps)) return rows;
  } catch (const UserError&) {
  }
  return std::nullopt;
}

/// Nothing if interrupted.
std::optional<WindowRows> fetch_window(const FetchRequest& request, const FetchWindow& window,
                                       const std::atomic<bool>& interrupted) {
  std::optional<WindowDownload> download = download_window(request, window, interrupted);
  if (!download) return std::nullopt;
  const MarketRows& rows = download->rows.rows;
  const bool complete = holes_in(window, rows, request.now_utc_s).empty();
  const bool finished = !window.settles_later && count_of(rows) > 0 && !download->text.empty() &&
                        (complete || request.allow_gaps);
  if (finished) write_file(window_path(request, window), download->text);
  return std::move(download->rows);
}

struct FetchedWindow {
  FetchWindow window;
  WindowRows rows{};
  std::vector<Gap> gaps{};  ///< without an end that is still being published
};

/// Nothing if interrupted. Cached windows come first, so that the rate is that of the downloads.
std::optional<std::vector<FetchedWindow>> fetch_windows(const FetchRequest& request,
                                                        const std::atomic<bool>& interrupted) {
  std::vector<FetchedWindow> all;
  for (const FetchWindow& window : plan_fetch(request.span, request.now_utc_s)) {
    all.push_back({window});
  }
  std::vector<FetchedWindow*> wanted;
  for (FetchedWindow& of : all) {
    if (interrupted) return std::nullopt;
    std::optional<WindowRows> kept = kept_rows(request, of.window);
    if (kept) of.rows = std::move(*kept);
    if (!kept) wanted.push_back(&of);
  }
  if (wanted.size() < all.size()) {
    fmt::print(stderr, "fetch: {} kept from an earlier run\n",
               counted(all.size() - wanted.size(), "window"));
  }
  Progress progress("fetch", "windows", static_cast<double>(wanted.size()));
  double done = 0;
  for (FetchedWindow* of : wanted) {
    progress.update(done++, of->window.dataset);
    std::optional<WindowRows> fetched = fetch_window(request, of->window, interrupted);
    if (!fetched) return std::nullopt;
    of->rows = std::move(*fetched);
  }
  progress.update(done);
  return all;
}

void remove_kept_windows(const FetchRequest& request) {
  std::error_code error;
  fs::remove_all(fetch_cache_folder(request), error);  // failure wastes only disk space
}

[[noreturn]] void fail_without_prices(const FetchRequest& request, const FetchWindow& first) {
  remove_kept_windows(request);
  if (!first.settles_later) {
    fail("{}: has no prices from {} to {}; choose other days", request.base_url,
         format_local_date(request.span.from), format_local_date(request.span.to));
  }
  if (is_near_real_time(first.dataset)) {
    fail("{}: no prices of today yet; run again in a few minutes", request.base_url);
  }
  fail("{}: not published yet: {} is refreshed once a day; run again tomorrow", request.base_url,
       first.dataset);
}

/// Deletes cached windows that cannot be joined: they would fail again.
JoinedMarket join_or_forget(const FetchRequest& request, MarketRows rows) {
  try {
    return join_market(std::move(rows), request.base_url);
  } catch (const UserError&) {
    remove_kept_windows(request);
    throw;
  }
}

/// Part of the span that daily datasets do not contain yet.
std::string describe_unpublished(const FetchedWindow& of) {
  const FetchWindow& window = of.window;
  const MarketRows& rows = of.rows.rows;
  if (!window.settles_later || is_near_real_time(window.dataset)) return {};
  std::int64_t end_utc_s = window.from_utc_s;
  for (const MinuteRow& row : rows.minutes) end_utc_s = std::max(end_utc_s, row.utc_s + 60);
  for (const QuarterHour& row : rows.quarter_hours) {
    end_utc_s = std::max(end_utc_s, row.utc_s + kSecondsPerQuarterHour);
  }
  if (end_utc_s >= window.until_utc_s) return {};
  return fmt::format(
      "{}: not published yet from {} to {}: it is refreshed once a day; run again tomorrow\n",
      window.dataset, utc_text(end_utc_s).view(), utc_text(window.until_utc_s).view());
}

std::string describe_windows(const std::vector<FetchedWindow>& windows) {
  std::string text;
  std::size_t unended = 0;
  for (const FetchedWindow& of : windows) {
    const std::string unpublished = describe_unpublished(of);
    if (unpublished.empty() && of.rows.received == 0) {
      text += fmt::format("{}: no rows from {} to {}\n", of.window.dataset,
                          utc_text(of.window.from_utc_s).view(),
                          utc_text(of.window.until_utc_s).view());
    }
    text += unpublished;
    unended += of.rows.unended;
  }
  if (unended > 0) {
    text += fmt::format("{} dropped: minutes or quarter-hours that had not ended\n",
                        counted(unended, "row"));
  }
  return text;
}

/// Missing ends of the span without a row in any window are described with the windows.
std::string describe_coverage(const FetchRequest& request,
                              const std::vector<FetchedWindow>& windows,
                              const MinuteSeries& series) {
  const auto nothing = [](std::int64_t from_utc_s, std::int64_t until_utc_s) {
    return fmt::format("nothing published from {} to {}\n", utc_text(from_utc_s).view(),
                       utc_text(until_utc_s).view());
  };
  std::string text;
  std::int64_t from_utc_s = series.start_utc_s;
  const std::int64_t end_utc_s = series.utc_s(series.size());
  std::int64_t until_utc_s = end_utc_s;
  for (const FetchedWindow& of : windows) {
    if (count_of(of.rows.rows) == 0) continue;
    from_utc_s = std::min(from_utc_s, of.window.from_utc_s);
    if (!describe_unpublished(of).empty()) continue;
    until_utc_s = std::max(until_utc_s, std::min(of.window.until_utc_s, request.now_utc_s));
  }
  if (from_utc_s < series.start_utc_s) text += nothing(from_utc_s, series.start_utc_s);
  if (end_utc_s + kSecondsPerQuarterHour < until_utc_s) text += nothing(end_utc_s, until_utc_s);
  return text;
}

/// Backwards: only an end that no later rows follow may still be published.
void find_gaps(const FetchRequest& request, std::vector<FetchedWindow>& windows) {
  bool minutes_follow = false;
  bool quarter_hours_follow = false;
  for (FetchedWindow& of : std::views::reverse(windows)) {
    bool& follow = holds_minutes(of.window.dataset) ? minutes_follow : quarter_hours_follow;
    of.gaps = holes_in(of.window, of.rows.rows, request.now_utc_s);
    const bool ends_open = !follow && of.window.settles_later && !of.rows.lacks_rows_of_total();
    const std::int64_t end_utc_s = std::min(of.window.until_utc_s, request.now_utc_s);
    if (ends_open && !of.gaps.empty() &&
        of.gaps.back().until_utc_s + kSecondsPerQuarterHour > end_utc_s) {
      of.gaps.pop_back();
    }
    follow = follow || count_of(of.rows.rows) > 0;
  }
}

/// "ods046: 2780 of 2880 minutes missing, the first from ... to ...; the server has no more".
std::string describe_missing(const FetchedWindow& of, std::int64_t now_utc_s) {
  const bool minutes = holds_minutes(of.window.dataset);
  const std::int64_t missing_min = minutes_in(of.gaps);
  const bool has_empty_rows =
      missing_min > minutes_in(missing_in(of.window, of.rows.rows, now_utc_s));
  std::string text = fmt::format(
      "{} of {} {} {} in {}, first from {} to {}", minutes ? missing_min : missing_min / 15,
      expected_rows(of.window, now_utc_s), minutes ? "minutes" : "quarter-hours",
      has_empty_rows ? "missing or without a price" : "missing", of.window.dataset,
      utc_text(of.gaps.front().from_utc_s).view(), utc_text(of.gaps.front().until_utc_s).view());
  const std::optional<std::size_t>& total = of.rows.total;
  if (of.rows.lacks_rows_of_total()) {
    text += fmt::format(" (the server counts {} and sent {})", counted(*total, "row"),
                        of.rows.distinct);
  } else if (total) {
    text += " (the server has no more)";
  } else if (of.window.settles_later) {
    text += " (refreshed once a day: perhaps tomorrow)";
  }
  return text;
}

/// One line for each window with gaps; throws UserError for the first unless they are allowed.
std::string describe_allowed_gaps(const FetchRequest& request,
                                  const std::vector<FetchedWindow>& windows) {
  std::vector<std::string> missing;
  for (const FetchedWindow& of : windows) {
    if (!of.gaps.empty()) missing.push_back(describe_missing(of, request.now_utc_s));
  }
  if (!missing.empty() && !request.allow_gaps) {
    fail("{}{}: {}; run again later, or with --allow-gaps for a file with gaps", missing.front(),
         missing.size() == 1
             ? ""
             : fmt::format(", and {} with gaps", counted(missing.size() - 1, "window")),
         host_of(request.base_url));
  }
  std::string text;
  for (const std::string& line : missing) text += line + "\n";
  return text;
}

std::string provenance_of(const FetchRequest& request, const std::vector<FetchedWindow>& windows) {
  std::string datasets;
  for (const FetchedWindow& of : windows) {
    const std::string& dataset = of.window.dataset;
    if (datasets.find(dataset) == std::string::npos) datasets += " " + dataset;
  }
  return fmt::format("{}\nDatasets{} fetched {} from {} by bess-train {}\n",
                     attribution_of({MarketSource::kElia}), datasets,
                     utc_text(request.now_utc_s).view(), request.base_url, BESS_VERSION);
}

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

bool holds_minutes(std::string_view dataset) {
  return dataset == kOld.minutes || dataset == kNew.minutes || dataset == kToday.minutes;
}

std::vector<FetchWindow> plan_fetch(const FetchSpan& span, std::int64_t now_utc_s) {
  if (span.to < span.from) {
    fail("--to {} is before --from {}; swap them", format_local_date(span.to),
         format_local_date(span.from));
  }
  const LocalDate today = local_date_of(now_utc_s);
  if (today < span.from) {
    fail("--from {} is in the future; prices exist until today", format_local_date(span.from));
  }
  const LocalDate end = add_days(std::min(span.to, today), 1);
  std::vector<FetchWindow> windows;
  for (LocalDate from = span.from; from < end;) {
    const LocalDate until = window_end(from, end, today);
    const DatasetPair datasets = datasets_of(from, today);
    const std::int64_t until_utc_s = local_midnight_utc_s(until);
    const bool settles_later = until_utc_s > now_utc_s - kFillingDays * kSecondsPerDay;
    for (const char* dataset : {datasets.minutes, datasets.quarter_hours}) {
      windows.push_back({dataset, local_midnight_utc_s(from), until_utc_s, settles_later});
    }
    from = until;
  }
  return windows;
}

fs::path fetch_cache_folder(const FetchRequest& request) { return request.out.string() + ".fetch"; }

std::optional<FetchedPrices> fetch_prices(const FetchRequest& request,
                                          const std::atomic<bool>& interrupted) {
  std::optional<std::vector<FetchedWindow>> windows = fetch_windows(request, interrupted);
  if (!windows) return std::nullopt;
  MarketRows all;
  for (const FetchedWindow& of : *windows) append_rows(all, of.rows.rows);
  if (count_of(all) == 0) fail_without_prices(request, windows->front().window);
  find_gaps(request, *windows);
  const std::string gaps = describe_allowed_gaps(request, *windows);
  FetchedPrices fetched{join_or_forget(request, std::move(all)), {}};
  judge(implausible(fetched.market.series), request.accepted, {{host_of(request.base_url), {}}});
  fetched.description = describe_join(fetched.market) + describe_windows(*windows) +
                        describe_coverage(request, *windows, fetched.market.series) + gaps;
  write_minute_file(request.out, fetched.market.series,
                    provenance_of(request, *windows) + fetched.description);
  remove_kept_windows(request);
  return fetched;
}

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
