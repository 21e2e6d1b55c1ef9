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
#include "workstation/data/market/feed/market_join.h"
#include "workstation/data/market/series/checked_prices.h"
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

/// Dataset that is refreshed all day; the others once a day.
bool is_near_real_time(std::string_view dataset);

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

}  // namespace bess
