// Where day-ahead prices come from: a server or a file that somebody else writes, asked for today
// and tomorrow, and when to ask. The one who asks is a thread of bess-prices (outlook_fetcher.h).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "edge/core/base/status.h"
#include "edge/prices/fetch/day_ahead_book.h"
#include "edge/prices/record/price_settings.h"
#include "shared/host/day_ahead_rows.h"
#include "shared/host/http_client.h"

namespace bess {

// What is kept of day-ahead prices over a restart: one file in the state folder, a line a
// quarter-hour, replaced at once and checked as a whole.
//   # bess day-ahead 1: quarter-hour, hundredths of EUR/MWh, received
//   2026-11-23T23:00:00Z 4150 2026-11-23T11:57:12Z
//   # crc32=0123abcd
// Nothing here allocates.

inline constexpr const char* kDayAheadFileName = "day_ahead";

/// False with errno set.
bool keep_day_ahead(const char* path, const DayAheadBook& book);

/// How many prices came back; 0 where there is no file, or none that is whole: they are fetched
/// again.
int restore_day_ahead(const char* path, DayAheadBook& book);

/// What a status means when it comes from there, and what mends it.
std::string_view day_ahead_status_text(Status status, const OutlookSettings& settings);

using DayAheadUrl = FixedText<639>;
DayAheadUrl day_ahead_url(std::string_view url, const OutlookDays& days);

/// What came of asking; `days` of kOk alone.
struct DayAheadAsked {
  Status status = Status::kNotConnected;
  std::string reason{};  ///< of anything else: one line, where there is more to say than the status
  std::vector<DayAheadDay> days{};
};
DayAheadAsked read_day_ahead(std::string_view answer, const PriceFields& fields);
/// Asks for the days around now, within the time-out.
DayAheadAsked ask_day_ahead(const OutlookSettings& settings, std::int64_t now_utc_s,
                            const StopRequested& stop_requested);

/// From when on there is something to ask for: now where something of today is missing, for
/// tomorrow 12:50 local time.
std::int64_t due_utc_s(const DayAheadBook& book, const OutlookSettings& settings,
                       std::int64_t now_utc_s);
/// When to ask next: when it is due, and while nothing whole comes after a minute, two, four, to
/// half an hour. `last_utc_s`: 0 = not asked yet; `tries`: in vain, after which it was still due.
std::int64_t next_ask_utc_s(const DayAheadBook& book, const OutlookSettings& settings,
                            std::int64_t now_utc_s, std::int64_t last_utc_s, int tries);

/// What was asked for, and what came of it.
struct DayAheadInquiry {
  DayAheadBook book{};
  Status status = Status::kNoRow;  ///< of the last answer
  std::int64_t last_utc_s = 0;
  int tries = 0;

  [[nodiscard]] bool is_due(const OutlookSettings& settings, std::int64_t now_utc_s) const {
    return next_ask_utc_s(book, settings, now_utc_s, last_utc_s, tries) <= now_utc_s;
  }
  /// An answer, or why there is none. True when the book holds something new.
  bool take(const DayAheadAsked& asked, const OutlookSettings& settings, std::int64_t now_utc_s);
};

}  // namespace bess
