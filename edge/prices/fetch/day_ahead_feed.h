// Day-ahead feed: reads a server or a file that another program writes, for today and tomorrow, and
// schedules the requests. A thread of bess-prices uses it (outlook_fetcher.h).
#pragma once

#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edge/core/base/status.h"
#include "edge/prices/record/price_settings.h"
#include "shared/host/day_ahead_rows.h"
#include "shared/host/http_client.h"
#include "shared/outlook/outlook_plan.h"

namespace bess {

// Day-ahead prices received so far, by quarter-hour, with their time of receipt. Known at an
// instant is what was received by then; tomorrow's prices not before 13:00 local time, as on the
// workstation (workstation/data/market/series/day_ahead.h), which rejects earlier prices.
//
// Of a whole day the first answer is kept. Refused is an answer, or a day of it, that is
//   different   from a tenth of the stored prices: shifted by an hour or a day, or another market
//   repeated    from the previous day, price by price: an old answer
//   constant    all day: zeros published until the auction
// Stored prices then stay valid until the end of their day, unless a server repeats the same
// different answer for three hours. Prices assumed by the layout
// (day_ahead_rows.h) are planned on, but their day is incomplete: it is requested again, and a
// later answer replaces them; if unchanged after hours, they are accepted.

/// A stored price.
struct KnownPrice {
  std::int64_t utc_s = 0;  ///< start of its quarter-hour; 0 = none
  std::int64_t received_utc_s = 0;
  std::int32_t centi_eur_per_mwh = 0;
  bool is_assumed = false;
};

class DayAheadStore {
 public:
  static constexpr int kPricesMax = 512;  ///< more than five days

  /// Stores an answer. kOk: a price of yesterday, today or tomorrow is stored; kNoRow: none of
  /// these days; kImplausible: refused as above, entirely or for a day; kDoubtfulUnit: all prices
  /// of a day are below 5 EUR/MWh.
  Status take(std::span<const DayAheadDay> days, std::int64_t now_utc_s);
  /// Restores a price stored by an earlier run. False if no run would store it.
  bool restore(const KnownPrice& price);

  /// The days around an instant, with the prices known at that time.
  [[nodiscard]] OutlookDays days_at(std::int64_t utc_s) const;
  /// True if every quarter-hour of [from, until) was received by `now_utc_s`, none of them assumed.
  [[nodiscard]] bool has_all(std::int64_t from_utc_s, std::int64_t until_utc_s,
                             std::int64_t now_utc_s) const;
  /// Number of prices stored since the start; unchanged means that the file is up to date.
  [[nodiscard]] std::uint32_t changes() const { return changes_; }
  /// For the file: utc_s == 0 is an empty entry; assumed prices are requested again.
  [[nodiscard]] std::span<const KnownPrice> prices() const { return prices_; }

 private:
  struct Answer : OutlookDays {
    bool is_assumed[std::size(OutlookDays{}.day_ahead_centi)] = {};
    friend bool operator==(const Answer&, const Answer&) = default;
  };
  [[nodiscard]] const KnownPrice* find(std::int64_t utc_s, std::int64_t now_utc_s) const;
  [[nodiscard]] bool disagrees(const Answer& answer, std::int64_t now_utc_s) const;
  [[nodiscard]] bool repeats_day_before(const OutlookDays& answer, int day,
                                        std::int64_t now_utc_s) const;
  void keep_day(const Answer& answer, int day, std::int64_t now_utc_s);
  bool is_repeated(const Answer& answer, std::int64_t now_utc_s);
  void forget(const Answer& answer);

  std::uint32_t changes_ = 0;
  std::optional<Answer> refused_;  ///< newest answer that contradicts the stored prices
  std::int64_t refused_utc_s_ = 0;
  KnownPrice prices_[kPricesMax] = {};  ///< index: number of the quarter-hour modulo the size
};

/// Time at which tomorrow's prices count as known: 13:00 local time of the day starting then.
std::int64_t publication_utc_s(std::int64_t today_midnight_utc_s);

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
