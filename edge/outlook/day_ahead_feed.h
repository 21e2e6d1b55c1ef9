// Where day-ahead prices come from: a server or a file that somebody else writes, asked for today
// and tomorrow, and when to ask. The one who asks is a thread of outlook_watch.h.
#pragma once

#include <cstdint>

#include "edge/base/status.h"
#include "edge/outlook/day_ahead_book.h"
#include "edge/prices/http_client.h"
#include "edge/prices/price_json.h"

namespace bess {

/// energy-charts, of Belgium; {today} and {tomorrow} in a url stand for local dates.
inline HttpSettings usual_day_ahead_server() {
  HttpSettings http;
  http.url = "https://api.energy-charts.info/price?bzn=BE&start={today}&end={tomorrow}";
  http.timeout_ms = 10'000;
  return http;
}

struct OutlookSettings {
  HttpSettings http = usual_day_ahead_server();
  PriceFields fields{.rows = "", .time = "unix_seconds", .price = "price"};
  FixedText<639> file;            ///< with the answer of such a server; empty: the url is asked
  std::int32_t ask_offset_s = 0;  ///< so that many machines do not ask at one instant
};

/// What a status means when it comes from there, and what mends it.
std::string_view day_ahead_status_text(Status status, const OutlookSettings& settings);

using DayAheadUrl = FixedText<639>;
DayAheadUrl day_ahead_url(std::string_view url, const OutlookDays& days);

class DayAheadFeed {
 public:
  static constexpr std::size_t kRowsMax = 4 * kLongestDayQuarterHours;
  static constexpr std::size_t kFileBytesMax = 32 * 1024;

  explicit DayAheadFeed(const OutlookSettings& settings)
      : settings_(settings), http_(settings.http) {}

  /// Asks for the days around now and gives `rows()` what is answered; within the time-out.
  /// kTooLarge: also of more rows than four days have.
  Status ask(std::int64_t now_utc_s);
  [[nodiscard]] std::span<const TimedPrice> rows() const { return {rows_, count_}; }

 private:
  Status fetch(std::int64_t now_utc_s, std::string_view& answer);
  static void take_row(void* self, const PriceRow& row);

  OutlookSettings settings_;
  HttpClient http_;
  char file_text_[kFileBytesMax];
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
