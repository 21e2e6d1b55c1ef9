#include "workstation/market/elia_fetch.h"

#include <fmt/format.h>

#include <algorithm>

#include "shared/crc32.h"
#include "workstation/io/file.h"
#include "workstation/io/progress.h"
#include "workstation/io/user_error.h"
#include "workstation/market/http_client.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using Kind = HttpOutcome::Kind;

std::string window_url(const std::string& base_url, const FetchWindow& window) {
  // Explicit offsets: the API reads naive times as UTC or local, depending on other parameters.
  const auto instant = [](std::int64_t utc_s) {
    std::string text = format_utc(utc_s);
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

/// A server may ignore the window: rows outside it are dropped.
MarketRows rows_in_window(std::string_view text, const std::string& name,
                          const FetchWindow& window) {
  MarketRows rows = parse_market_text(text, name);
  const auto outside = [&window](const auto& row) {
    return row.utc_s < window.from_utc_s || row.utc_s >= window.until_utc_s;
  };
  std::erase_if(rows.minutes, outside);
  std::erase_if(rows.quarter_hours, outside);
  return rows;
}

void append(MarketRows& all, const MarketRows& rows) {
  all.minutes.insert(all.minutes.end(), rows.minutes.begin(), rows.minutes.end());
  all.quarter_hours.insert(all.quarter_hours.end(), rows.quarter_hours.begin(),
                           rows.quarter_hours.end());
}

/// Seconds until the next attempt; throws when there should be none.
double next_wait_s(const RetryPolicy& retry, int attempts, const HttpOutcome& outcome,
                   const std::string& url) {
  const bool unreachable = outcome.kind == Kind::kUnreachable;
  const int attempts_max = unreachable ? retry.attempts_unreachable_max : retry.attempts_max;
  if (outcome.kind == Kind::kRefused || attempts >= attempts_max) {
    fail(
        "{}: {} ({} attempts); check --base-url and the network and run the same command again, "
        "finished windows are kept",
        url, outcome.reason, attempts);
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
  MarketRows rows;
};

/// An answer that cannot be read is tried again like a cut connection.
HttpOutcome get_rows(const std::string& url, const FetchWindow& window,
                     const std::atomic<bool>& interrupted, Download& download) {
  HttpOutcome outcome = http_get(url, interrupted);
  if (outcome.kind != Kind::kDone) return outcome;
  try {
    download.rows = rows_in_window(outcome.body, window.dataset, window);
    download.text = std::move(outcome.body);
    return outcome;
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
    const HttpOutcome outcome = get_rows(url, window, interrupted, download);
    if (outcome.kind == Kind::kDone) return download;
    if (outcome.kind == Kind::kInterrupted) break;
    const double wait_s = next_wait_s(request.retry, attempts, outcome, url);
    fmt::print(stderr, "{}: {}; next attempt in {:.0f} s\n", window.dataset, outcome.reason,
               wait_s);
    request.sleep(wait_s, interrupted);
  }
  return std::nullopt;
}

/// Rows of a window that an earlier run finished; a damaged copy counts as none.
std::optional<MarketRows> cached_rows(const fs::path& path, const FetchWindow& window) {
  if (window.settles_later || !fs::exists(path)) return std::nullopt;
  try {
    return rows_in_window(read_file(path), path.string(), window);
  } catch (const UserError&) {
    return std::nullopt;
  }
}

/// Nothing when interrupted.
std::optional<MarketRows> fetch_window(const FetchRequest& request, const FetchWindow& window,
                                       const std::atomic<bool>& interrupted) {
  const fs::path cached = window_path(request, window);
  if (std::optional<MarketRows> rows = cached_rows(cached, window)) return rows;
  std::optional<Download> download = download_window(request, window, interrupted);
  if (!download) return std::nullopt;
  if (!window.settles_later) write_file(cached, download->text);
  return std::move(download->rows);
}

std::string describe_coverage(const FetchRequest& request, const std::vector<FetchWindow>& windows,
                              const MinuteSeries& series) {
  std::string text;
  const std::int64_t from_utc_s = windows.front().from_utc_s;
  const std::int64_t until_utc_s = std::min(windows.back().until_utc_s, request.now_utc_s);
  const std::int64_t end_utc_s = series.utc_s(series.size());
  if (from_utc_s < series.start_utc_s) {
    text += fmt::format("nothing published from {} to {}\n", format_utc(from_utc_s),
                        format_utc(series.start_utc_s));
  }
  if (end_utc_s + 900 < until_utc_s) {
    text += fmt::format("nothing published from {} to {}\n", format_utc(end_utc_s),
                        format_utc(until_utc_s));
  }
  return text;
}

std::string provenance_of(const FetchRequest& request, const std::vector<FetchWindow>& windows) {
  std::string datasets;
  for (const FetchWindow& window : windows) {
    if (datasets.find(window.dataset) == std::string::npos) datasets += " " + window.dataset;
  }
  return fmt::format("{}\nDatasets{} fetched {} from {} by bess-train {}\n", kEliaAttribution,
                     datasets, format_utc(request.now_utc_s), request.base_url, BESS_VERSION);
}

}  // namespace

fs::path fetch_cache_folder(const FetchRequest& request) { return request.out.string() + ".fetch"; }

std::optional<FetchedPrices> fetch_prices(const FetchRequest& request,
                                          const std::atomic<bool>& interrupted) {
  const std::vector<FetchWindow> windows = plan_fetch(request.span, request.now_utc_s);
  MarketRows rows;
  {
    Progress progress("fetch", "windows", static_cast<double>(windows.size()));
    for (std::size_t i = 0; i < windows.size(); ++i) {
      progress.update(static_cast<double>(i), windows[i].dataset);
      const std::optional<MarketRows> window_rows = fetch_window(request, windows[i], interrupted);
      if (!window_rows) return std::nullopt;
      append(rows, *window_rows);
    }
    progress.update(static_cast<double>(windows.size()));
  }
  if (rows.minutes.empty() && rows.quarter_hours.empty()) {
    fail("{}: holds no prices from {} to {}; choose other days", request.base_url,
         format_local_date(request.span.from), format_local_date(request.span.to));
  }
  FetchedPrices fetched{join_market(std::move(rows), request.base_url), {}};
  fetched.description =
      describe_join(fetched.market) + describe_coverage(request, windows, fetched.market.series);
  write_minute_file(request.out, fetched.market.series,
                    provenance_of(request, windows) + fetched.description);
  std::error_code error;
  fs::remove_all(fetch_cache_folder(request), error);  // a leftover is only wasted space
  return fetched;
}

}  // namespace bess
