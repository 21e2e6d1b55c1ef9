#include "workstation/market/feed/elia_fetch.h"

#include <fmt/core.h>

#include <algorithm>

#include "shared/crc32.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "workstation/base/progress.h"
#include "workstation/market/feed/http_client.h"
#include "workstation/market/feed/market_files.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using Kind = HttpOutcome::Kind;

std::string window_url(const std::string& base_url, const FetchWindow& window) {
  // Explicit offsets: the API reads naive times as UTC or local, depending on other parameters.
  const auto instant = [](std::int64_t utc_s) {
    std::string text(utc_text(utc_s).view());
    return text.replace(text.size() - 1, 1, "+00:00");
  };
  const std::string where = fmt::format("datetime >= \"{}\" AND datetime < \"{}\"",
                                        instant(window.from_utc_s), instant(window.until_utc_s));
  return fmt::format(
      "{}/catalog/datasets/{}/exports/csv?where={}&order_by=datetime&timezone=UTC"
      "&delimiter=%3B",
      base_url, window.dataset, url_encoded(where));
}

/// Cached windows of another server are never taken for this one's.
fs::path window_path(const FetchRequest& request, const FetchWindow& window) {
  Crc32 server;
  server.add_bytes(request.base_url.data(), request.base_url.size());
  return fetch_cache_folder(request) / fmt::format("{}_{}_{}_{:08x}.csv.gz", window.dataset,
                                                   window.from_utc_s, window.until_utc_s,
                                                   server.value());
}

/// Another try would bring the same rows again.
struct WindowIgnored : UserError {
  using UserError::UserError;
};

struct WindowRows {
  MarketRows rows;
  std::size_t received = 0;  ///< before any was dropped
  std::size_t unended = 0;   ///< dropped: of intervals that had not ended
};

std::size_t count_of(const MarketRows& rows) {
  return rows.minutes.size() + rows.quarter_hours.size();
}

/// Drops the rows whose interval [from, until) `unwanted` names.
template <typename Unwanted>
void drop_rows(MarketRows& rows, Unwanted unwanted) {
  const auto minute = [&](std::int64_t utc_s) { return unwanted(utc_s, utc_s + 60); };
  const auto quarter_hour = [&](std::int64_t utc_s) {
    return unwanted(utc_s, utc_s + kSecondsPerQuarterHour);
  };
  std::erase_if(rows.minutes, [&](const MinuteRow& row) { return minute(row.utc_s); });
  std::erase_if(rows.quarter_hours,
                [&](const QuarterHour& row) { return quarter_hour(row.utc_s); });
  std::erase_if(rows.dual_priced_minutes, minute);
  std::erase_if(rows.dual_priced_quarter_hours, quarter_hour);
}

/// An empty body holds no rows; a server may ignore the window: rows outside it are dropped.
WindowRows rows_in_window(std::string_view text, const std::string& name, const FetchWindow& window,
                          std::int64_t now_utc_s) {
  WindowRows result;
  if (without_byte_order_mark(text).find_first_not_of(" \t\r\n") == text.npos) return result;
  result.rows = parse_market_text(text, name);
  result.received = count_of(result.rows);
  drop_rows(result.rows, [&window](std::int64_t from_utc_s, std::int64_t) {
    return from_utc_s < window.from_utc_s || from_utc_s >= window.until_utc_s;
  });
  if (result.received > 0 && count_of(result.rows) == 0) {
    throw WindowIgnored(fmt::format("the server ignored the time window: {} came, none inside it",
                                    counted(result.received, "row")));
  }
  const std::size_t inside = count_of(result.rows);
  drop_rows(result.rows, [now_utc_s](std::int64_t, std::int64_t until_utc_s) {
    return until_utc_s > now_utc_s;
  });
  result.unended = inside - count_of(result.rows);
  return result;
}

/// Seconds until the next attempt; throws when there should be none.
double next_wait_s(const RetryPolicy& retry, int attempts, const HttpOutcome& outcome,
                   const std::string& url) {
  const bool unreachable = outcome.kind == Kind::kUnreachable;
  const int attempts_max = unreachable ? retry.attempts_unreachable_max : retry.attempts_max;
  if (outcome.kind == Kind::kRefused || attempts >= attempts_max) {
    fail(
        "{}: {} ({}); check --base-url and the network and run the same command again, "
        "finished windows are kept",
        url, outcome.reason, counted(static_cast<std::size_t>(attempts), "attempt"));
  }
  const double backoff_s = retry.first_wait_s * static_cast<double>(1 << (attempts - 1));
  const double wait_s = std::max(outcome.wait_s.value_or(0.0), backoff_s);
  if (wait_s > retry.wait_max_s) {
    fail(
        "{}: {}; the server asks to wait {:.0f} minutes: run the same command again then, finished "
        "windows are kept",
        url, outcome.reason, wait_s / 60);
  }
  return wait_s;
}

struct Download {
  std::string text;
  WindowRows rows;
};

/// An answer that cannot be read is tried again like a cut connection.
HttpOutcome get_rows(const FetchRequest& request, const std::string& url, const FetchWindow& window,
                     const std::atomic<bool>& interrupted, Download& download) {
  HttpOutcome outcome = http_get(url, interrupted);
  if (outcome.kind != Kind::kDone) return outcome;
  try {
    download.rows = rows_in_window(outcome.body, window.dataset, window, request.now_utc_s);
    download.text = std::move(outcome.body);
    return outcome;
  } catch (const WindowIgnored& error) {
    return {Kind::kRefused, {}, error.what(), {}};
  } catch (const UserError& error) {
    return {Kind::kTransient, {}, fmt::format("cannot read the answer: {}", error.what()), {}};
  }
}

/// Nothing when interrupted.
std::optional<Download> download_window(const FetchRequest& request, const FetchWindow& window,
                                        const std::atomic<bool>& interrupted) {
  const std::string url = window_url(request.base_url, window);
  Download download;
  for (int attempts = 1; !interrupted; ++attempts) {
    const HttpOutcome outcome = get_rows(request, url, window, interrupted, download);
    if (outcome.kind == Kind::kDone) return download;
    if (outcome.kind == Kind::kInterrupted) break;
    const double wait_s = next_wait_s(request.retry, attempts, outcome, url);
    fmt::print(stderr, "{}: {}; next attempt in {:.0f} s\n", window.dataset, outcome.reason,
               wait_s);
    request.sleep(wait_s, interrupted);
  }
  return std::nullopt;
}

/// Rows of a window that an earlier run finished; a damaged or empty copy counts as none.
std::optional<WindowRows> kept_rows(const FetchRequest& request, const FetchWindow& window) {
  const fs::path path = window_path(request, window);
  if (window.settles_later || !fs::exists(path)) return std::nullopt;
  try {
    WindowRows rows = rows_in_window(read_file(path), path.string(), window, request.now_utc_s);
    if (count_of(rows.rows) > 0) return rows;
  } catch (const UserError&) {
  }
  return std::nullopt;
}

/// Nothing when interrupted.
std::optional<WindowRows> fetch_window(const FetchRequest& request, const FetchWindow& window,
                                       const std::atomic<bool>& interrupted) {
  std::optional<Download> download = download_window(request, window, interrupted);
  if (!download) return std::nullopt;
  const bool finished = !window.settles_later && count_of(download->rows.rows) > 0;
  if (finished) write_file(window_path(request, window), download->text);
  return std::move(download->rows);
}

/// Rows of each window, or nothing when interrupted. Kept windows come first, so that the rate shown
/// is that of the downloads.
std::optional<std::vector<WindowRows>> fetch_windows(const FetchRequest& request,
                                                     const std::vector<FetchWindow>& windows,
                                                     const std::atomic<bool>& interrupted) {
  std::vector<WindowRows> rows(windows.size());
  std::vector<std::size_t> wanted;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    if (interrupted) return std::nullopt;
    std::optional<WindowRows> kept = kept_rows(request, windows[i]);
    if (kept) rows[i] = std::move(*kept);
    if (!kept) wanted.push_back(i);
  }
  if (wanted.size() < windows.size()) {
    fmt::print(stderr, "fetch: {} kept from an earlier run\n",
               counted(windows.size() - wanted.size(), "window"));
  }
  Progress progress("fetch", "windows", static_cast<double>(wanted.size()));
  for (std::size_t done = 0; done < wanted.size(); ++done) {
    const FetchWindow& window = windows[wanted[done]];
    progress.update(static_cast<double>(done), window.dataset);
    std::optional<WindowRows> fetched = fetch_window(request, window, interrupted);
    if (!fetched) return std::nullopt;
    rows[wanted[done]] = std::move(*fetched);
  }
  progress.update(static_cast<double>(wanted.size()));
  return rows;
}

void remove_kept_windows(const FetchRequest& request) {
  std::error_code error;
  fs::remove_all(fetch_cache_folder(request), error);  // a leftover is only wasted space
}

[[noreturn]] void fail_without_prices(const FetchRequest& request, const FetchWindow& first) {
  remove_kept_windows(request);
  if (!first.settles_later) {
    fail("{}: holds no prices from {} to {}; choose other days", request.base_url,
         format_local_date(request.span.from), format_local_date(request.span.to));
  }
  if (is_near_real_time(first.dataset)) {
    fail("{}: no prices of today yet; run again in some minutes", request.base_url);
  }
  fail("{}: not published yet: {} is refreshed once a day; run again tomorrow", request.base_url,
       first.dataset);
}

/// Kept windows that cannot be used would only bring the same failure again.
JoinedMarket join_or_forget(const FetchRequest& request, MarketRows rows) {
  try {
    return join_market(std::move(rows), request.base_url);
  } catch (const UserError&) {
    remove_kept_windows(request);
    throw;
  }
}

/// What the datasets that are refreshed once a day do not hold yet.
std::string describe_unpublished(const FetchWindow& window, const MarketRows& rows) {
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

std::string describe_windows(const std::vector<FetchWindow>& windows,
                             const std::vector<WindowRows>& rows) {
  std::string text;
  std::size_t unended = 0;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const std::string unpublished = describe_unpublished(windows[i], rows[i].rows);
    if (unpublished.empty() && rows[i].received == 0) {
      text += fmt::format("{}: no rows from {} to {}\n", windows[i].dataset,
                          utc_text(windows[i].from_utc_s).view(),
                          utc_text(windows[i].until_utc_s).view());
    }
    text += unpublished;
    unended += rows[i].unended;
  }
  if (unended > 0) {
    text += fmt::format("{} dropped: of minutes or quarter-hours that had not ended\n",
                        counted(unended, "row"));
  }
  return text;
}

/// Ends of the span where no window has a row are described with the windows.
std::string describe_coverage(const FetchRequest& request, const std::vector<FetchWindow>& windows,
                              const std::vector<WindowRows>& rows, const MinuteSeries& series) {
  std::string text;
  std::int64_t from_utc_s = series.start_utc_s;
  std::int64_t until_utc_s = series.utc_s(series.size());
  for (std::size_t i = 0; i < windows.size(); ++i) {
    if (count_of(rows[i].rows) == 0) continue;
    from_utc_s = std::min(from_utc_s, windows[i].from_utc_s);
    if (!describe_unpublished(windows[i], rows[i].rows).empty()) continue;
    until_utc_s = std::max(until_utc_s, std::min(windows[i].until_utc_s, request.now_utc_s));
  }
  const std::int64_t end_utc_s = series.utc_s(series.size());
  if (from_utc_s < series.start_utc_s) {
    text += fmt::format("nothing published from {} to {}\n", utc_text(from_utc_s).view(),
                        utc_text(series.start_utc_s).view());
  }
  if (end_utc_s + kSecondsPerQuarterHour < until_utc_s) {
    text += fmt::format("nothing published from {} to {}\n", utc_text(end_utc_s).view(),
                        utc_text(until_utc_s).view());
  }
  return text;
}

std::string provenance_of(const FetchRequest& request, const std::vector<FetchWindow>& windows) {
  std::string datasets;
  for (const FetchWindow& window : windows) {
    if (datasets.find(window.dataset) == std::string::npos) datasets += " " + window.dataset;
  }
  return fmt::format("{}\nDatasets{} fetched {} from {} by bess-train {}\n",
                     attribution_of({MarketSource::kElia}), datasets,
                     utc_text(request.now_utc_s).view(), request.base_url, BESS_VERSION);
}

}  // namespace

fs::path fetch_cache_folder(const FetchRequest& request) { return request.out.string() + ".fetch"; }

std::optional<FetchedPrices> fetch_prices(const FetchRequest& request,
                                          const std::atomic<bool>& interrupted) {
  const std::vector<FetchWindow> windows = plan_fetch(request.span, request.now_utc_s);
  const std::optional<std::vector<WindowRows>> rows = fetch_windows(request, windows, interrupted);
  if (!rows) return std::nullopt;
  MarketRows all;
  for (const WindowRows& of_window : *rows) append_rows(all, of_window.rows);
  if (count_of(all) == 0) fail_without_prices(request, windows.front());
  FetchedPrices fetched{join_or_forget(request, std::move(all)), {}};
  fetched.description = describe_join(fetched.market) + describe_windows(windows, *rows) +
                        describe_coverage(request, windows, *rows, fetched.market.series);
  write_minute_file(request.out, fetched.market.series,
                    provenance_of(request, windows) + fetched.description);
  remove_kept_windows(request);
  return fetched;
}

}  // namespace bess
