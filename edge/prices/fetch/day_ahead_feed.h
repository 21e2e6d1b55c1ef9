// Day-ahead feed: reads a server or a file that another program writes, for today and tomorrow, and
// schedules the requests. A thread of bess-prices uses it (outlook_fetcher.h).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/core/base/status.h"
#include "edge/prices/fetch/day_ahead_store.h"
#include "edge/prices/record/price_settings.h"
#include "shared/host/day_ahead_rows.h"
#include "shared/host/http_client.h"

namespace bess {

// State file of day-ahead prices: one file in the state folder, one line per quarter-hour, replaced
// atomically and checked as a whole.
//   # bess day-ahead 1: quarter-hour, hundredths of EUR/MWh, received
//   2026-11-23T23:00:00Z 4150 2026-11-23T11:57:12Z
//   # crc32=0123abcd

inline constexpr const char* kDayAheadFileName = "day_ahead";

/// False with errno set.
bool keep_day_ahead(const char* path, const DayAheadStore& store);

/// Number of restored prices; 0 without an intact file: they are fetched again.
int restore_day_ahead(const char* path, DayAheadStore& store);

/// Meaning and remedy of a status of this feed.
std::string_view day_ahead_status_text(Status status, const OutlookSettings& settings);

std::string day_ahead_url(std::string_view url, const OutlookDays& days);

/// Result of a request; `days` only for kOk.
struct DayAheadReply {
  Status status = Status::kNotConnected;
  std::string reason{};  ///< for other statuses: one line, if there is more to say
  std::vector<DayAheadDay> days{};
  double wait_s = 0;  ///< requested by the server
};
DayAheadReply read_day_ahead(std::string_view answer, const PriceFields& fields);
/// Requests the days around now, within the time-out.
DayAheadReply ask_day_ahead(const OutlookSettings& settings, std::int64_t now_utc_s,
                            const StopRequested& stop_requested);

/// Time of the next useful request: now if part of today is missing, 12:50 local time for tomorrow.
std::int64_t due_utc_s(const DayAheadStore& store, const OutlookSettings& settings,
                       std::int64_t now_utc_s);
/// Time of the next request: when due; after an incomplete answer one minute, two, up to half an
/// hour later. `last_utc_s`: 0 = no request yet; `tries`: incomplete requests so far; `wait_s`:
/// requested by the server.
std::int64_t next_ask_utc_s(const DayAheadStore& store, const OutlookSettings& settings,
                            std::int64_t now_utc_s, std::int64_t last_utc_s, int tries,
                            double wait_s = 0);

/// State of the requests.
struct DayAheadFetchState {
  DayAheadStore store{};
  Status status = Status::kNoRow;  ///< of the last answer
  std::string reason{};            ///< for other statuses than kOk: one line
  std::int64_t last_utc_s = 0;
  int tries = 0;
  double wait_s = 0;

  [[nodiscard]] bool is_due(const OutlookSettings& settings, std::int64_t now_utc_s) const {
    return next_ask_utc_s(store, settings, now_utc_s, last_utc_s, tries, wait_s) <= now_utc_s;
  }
  /// Takes an answer or its failure. True if the store has changed.
  bool take(const DayAheadReply& reply, const OutlookSettings& settings, std::int64_t now_utc_s);
};

}  // namespace bess
