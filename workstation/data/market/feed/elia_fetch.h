// Downloads a span of days from Elia's open data, window by window. Finished windows are kept in a
// folder beside the output until the whole span is written, so that an interrupted download goes on
// where it stopped; a file under its final name is always complete.
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
#include "workstation/data/market/series/judged_prices.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {

// Which dataset to ask for which time. Elia keeps minute and quarter-hour prices apart, changed
// datasets with the market design, and publishes the running day in datasets of its own:
//   until 21 May 2024   ods046 minutes, ods047 quarter-hours
//   since 22 May 2024   ods133 minutes, ods134 quarter-hours      (both refreshed once a day)
//   today               ods161 minutes, ods162 quarter-hours      (near real time)
// The last days before today are a window of their own, because they may still be filling.
// All borders are local midnights. Long spans are cut by local month: an export has no row limit,
// but an offset would bring one back, so time windows are the only way to page.

struct FetchWindow {
  std::string dataset;
  std::int64_t from_utc_s;
  std::int64_t until_utc_s;  ///< exclusive
  bool settles_later;        ///< may still be filling: a copy must not be kept
  friend bool operator==(const FetchWindow&, const FetchWindow&) = default;
};

struct FetchSpan {
  LocalDate from, to;  ///< both inclusive
};

/// A dataset that is refreshed all day; the others once a day.
bool is_near_real_time(std::string_view dataset);

/// A dataset of minutes; the others hold quarter-hours.
bool holds_minutes(std::string_view dataset);

/// Windows in order of time, quarter-hours after their minutes. Days after today are left out.
/// Throws UserError when nothing is left.
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
  int attempts_unreadable_max = 2;  ///< answers that arrive whole and are no data
  int attempts_slow_max = 2;        ///< answers that do not arrive in time
  HttpLimits limits{};              ///< of one answer
  double first_wait_s = 1;          ///< doubled after each attempt
  double wait_max_s = 900;          ///< a server that asks for longer ends the run, to be resumed
};

struct FetchRequest {
  FetchSpan span;
  std::filesystem::path out;
  std::string base_url = kEliaBaseUrl;  ///< the API root that ends in /api/explore/v2.1
  std::int64_t now_utc_s;
  RetryPolicy retry;
  bool allow_gaps = false;      ///< otherwise missing rows are an error, and no file is written
  AcceptedFindings accepted{};  ///< about the prices
  /// Between attempts; returns early when interrupted.
  std::function<void(double seconds, const std::atomic<bool>& interrupted)> sleep;
};

/// Folder of the finished windows.
std::filesystem::path fetch_cache_folder(const FetchRequest& request);

struct FetchedPrices {
  JoinedMarket market;
  std::string description;  ///< what was joined and what is missing, for the user
};

/// Downloads, joins, writes `out` with its provenance, removes the cache. Returns what it wrote, or
/// nothing when interrupted before all windows were in. Throws UserError. Either way finished
/// windows stay for the next run.
std::optional<FetchedPrices> fetch_prices(const FetchRequest& request,
                                          const std::atomic<bool>& interrupted);

}  // namespace bess
