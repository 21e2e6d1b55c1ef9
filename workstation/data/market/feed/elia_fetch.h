// Elia download, window by window. Complete windows are cached in a folder next to the output until
// the whole span is written, so an interrupted download is resumable; a file under its final name
// is always complete.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/http_client.h"
#include "workstation/data/market/feed/day_ahead_rows.h"
#include "workstation/data/market/feed/market_files.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {

// Datasets by time. Elia publishes minute and quarter-hour prices separately, changed the datasets
// with the market design, and has separate datasets for the running day:
//   until 21 May 2024   ods046 minutes, ods047 quarter-hours
//   since 22 May 2024   ods133 minutes, ods134 quarter-hours      (both refreshed once a day)
//   today               ods161 minutes, ods162 quarter-hours      (near real time)
// The last days before today are a separate window, because they may still be incomplete. All
// borders are local midnights. Long spans are split by local month: an export has no row limit but
// a request with an offset has, so time windows are the only paging.

struct FetchWindow {
  std::string dataset;
  std::int64_t from_utc_s;
  std::int64_t until_utc_s;  ///< exclusive
  bool settles_later;        ///< may still be incomplete: not cached
  friend bool operator==(const FetchWindow&, const FetchWindow&) = default;
};

struct FetchSpan {
  LocalDate from, to;  ///< both inclusive
};

/// Dataset of minutes; the others contain quarter-hours.
bool holds_minutes(std::string_view dataset);

/// Windows in order of time, quarter-hours after their minutes, without days after today. Throws
/// UserError if none is left.
std::vector<FetchWindow> plan_fetch(const FetchSpan& span, std::int64_t now_utc_s);

inline constexpr const char* kEliaBaseUrl = "https://opendata.elia.be/api/explore/v2.1";

inline HttpOutcome http_get(const std::string& url, const std::atomic<bool>& interrupted,
                            const HttpLimits& limits) {
  return http_request({.url = url, .limits = limits, .user_agent = "bess-train"},
                      [&] { return interrupted.load(); });
}

struct RetryPolicy {
  int attempts_max = 6;
  int attempts_unreachable_max = 3;
  int attempts_unreadable_max = 2;  ///< complete answers without data
  int attempts_slow_max = 2;        ///< time-outs
  HttpLimits limits{};              ///< per answer
  double first_wait_s = 1;          ///< doubled after each attempt
  double wait_max_s = 900;          ///< longer requested waits end the run, which is resumable
};

/// Wait between attempts; returns early if interrupted.
using Sleep = std::function<void(double seconds, const std::atomic<bool>& interrupted)>;

struct FetchRequest {
  FetchSpan span;
  std::filesystem::path out;
  std::string base_url = kEliaBaseUrl;  ///< the API root that ends in /api/explore/v2.1
  std::int64_t now_utc_s;
  RetryPolicy retry;
  bool allow_gaps = false;      ///< false: missing rows are an error without output
  AcceptedFindings accepted{};  ///< findings about the prices
  Sleep sleep;
};

/// Folder of the complete windows.
std::filesystem::path fetch_cache_folder(const FetchRequest& request);

struct FetchedPrices {
  JoinedMarket market;
  std::string description;  ///< joined and missing data, for the user
};

/// Downloads, joins, writes `out` with its provenance and removes the cache. Nothing if interrupted
/// before all windows are complete; throws UserError. In both cases complete windows remain for the
/// next run.
std::optional<FetchedPrices> fetch_prices(const FetchRequest& request,
                                          const std::atomic<bool>& interrupted);

// Download of one window: requests its rows with retries, compares them with the calendar and the
// server's total, and requests the rest until nothing is missing or the server has no more. The
// caller accepts or refuses the remaining gaps.

struct WindowRows {
  MarketRows rows;
  std::size_t received = 0;          ///< rows before any was dropped
  std::size_t unended = 0;           ///< dropped: interval not ended
  std::optional<std::size_t> total;  ///< the server's count, if requested and plausible
  std::size_t distinct = 0;          ///< times with a row, if the total was requested

  [[nodiscard]] bool lacks_rows_of_total() const { return total && distinct + unended < *total; }
};

/// Ended rows of a text inside the window; none for an empty text. Throws UserError if it cannot be
/// read.
WindowRows rows_in_window(std::string_view text, const std::string& name, const FetchWindow& window,
                          std::int64_t now_utc_s);

/// Minutes or quarter-hours with a price.
std::size_t count_of(const MarketRows& rows);

/// Ended minutes or quarter-hours of the window by the UTC calendar: a local day with a clock
/// change has 92 or 100 quarter-hours.
std::size_t expected_rows(const FetchWindow& window, std::int64_t now_utc_s);

/// Ended parts of the window without a row of the window's kind.
std::vector<Gap> missing_in(const FetchWindow& window, const MarketRows& rows,
                            std::int64_t now_utc_s);
/// The same, including quarter-hours without a price, which cannot be settled.
std::vector<Gap> holes_in(const FetchWindow& window, const MarketRows& rows,
                          std::int64_t now_utc_s);

struct WindowDownload {
  std::string text;  ///< all answers joined; empty if not possible
  WindowRows rows;
};

/// Nothing if interrupted. Throws UserError if the server does not answer.
std::optional<WindowDownload> download_window(const FetchRequest& request,
                                              const FetchWindow& window,
                                              const std::atomic<bool>& interrupted);

/// A request and the texts of its retries.
struct RetriedRequest {
  std::string url;
  std::string label;       ///< of the lines on standard error
  std::string subject;     ///< of an error: what is requested from which server
  std::string again;       ///< remedy
  std::string again_then;  ///< remedy after a wait
};

/// Requests until `read` takes the body of an answer; false if interrupted. `read` throws
/// NotMarketData for an answer that is final, or UserError for an unreadable one, which is
/// requested again, since a proxy may have changed it. Throws UserError after the last attempt.
bool get_with_retries(const RetriedRequest& request, const RetryPolicy& retry, const Sleep& sleep,
                      const std::atomic<bool>& interrupted,
                      const std::function<void(std::string body)>& read);

/// "opendata.elia.be" of a URL.
std::string host_of(const std::string& url);

// Day-ahead download from energy-charts (Fraunhofer ISE), which needs no key: one request per year
// or part of a year. No partial results are kept.

inline constexpr const char* kEnergyChartsBaseUrl = "https://api.energy-charts.info";

struct DayAheadRequest {
  FetchSpan span;
  std::string zone = "BE";  ///< bidding zone, as energy-charts names it
  std::string base_url = kEnergyChartsBaseUrl;
  std::int64_t now_utc_s;
  RetryPolicy retry;
  bool allow_gaps = false;
  Sleep sleep;
};

/// Nothing if interrupted. Throws UserError if the server does not answer, the answer is invalid,
/// or published days have gaps that are not allowed.
std::optional<JoinedDayAhead> fetch_day_ahead(const DayAheadRequest& request,
                                              const std::atomic<bool>& interrupted);

}  // namespace bess
