// Day-ahead download from energy-charts (Fraunhofer ISE), which needs no key: one request per year
// or part of a year. No partial results are kept.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "workstation/data/market/feed/day_ahead_rows.h"
#include "workstation/data/market/feed/elia_fetch.h"

namespace bess {

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
