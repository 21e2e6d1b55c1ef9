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
#pragma once

#include <cstdint>
#include <iterator>
#include <optional>
#include <span>

#include "edge/core/base/status.h"
#include "shared/host/day_ahead_rows.h"
#include "shared/outlook/outlook_plan.h"

namespace bess {

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

}  // namespace bess
