// Where day-ahead prices come from: a server or a file that somebody else writes, asked for today
// and tomorrow, and when to ask. The one who asks is a thread of bess-prices (outlook_fetcher.h).
#pragma once

#include <cstdint>

#include "edge/base/status.h"
#include "edge/fetch/day_ahead_book.h"
#include "edge/prices/outlook_settings.h"
#include "shared/host/http_client.h"

namespace bess {

/// What a status means when it comes from there, and what mends it.
std::string_view day_ahead_status_text(Status status, const OutlookSettings& settings);

using DayAheadUrl = FixedText<639>;
DayAheadUrl day_ahead_url(std::string_view url, const OutlookDays& days);

class DayAheadFeed {
 public:
  static constexpr std::size_t kRowsMax = 4 * kLongestDayQuarterHours;

  DayAheadFeed(const OutlookSettings& settings, StopRequested stop_requested)
      : settings_(settings), stop_requested_(std::move(stop_requested)) {}

  /// Asks for the days around now and gives `rows()` what is answered; within the time-out.
  /// kTooLarge: also of more rows than four days have.
  Status ask(std::int64_t now_utc_s);
  [[nodiscard]] std::span<const TimedPrice> rows() const { return {rows_, count_}; }

 private:
  Status fetch_answer(std::int64_t now_utc_s, std::string& answer) const;
  static void take_row(void* self, const PriceRow& row);

  OutlookSettings settings_;
  StopRequested stop_requested_;
  TimedPrice rows_[kRowsMax];
  std::size_t count_ = 0;
  bool is_too_large_ = false;
};

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
  bool take(Status asked, std::span<const TimedPrice> rows, const OutlookSettings& settings,
            std::int64_t now_utc_s);
};

}  // namespace bess
