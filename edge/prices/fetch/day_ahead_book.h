// The day-ahead prices that this machine has been told, by quarter-hour, and when it was told them:
// what is known at an instant is what had come by then, and of tomorrow nothing before 13:00 local
// time, as on the workstation (market/series/day_ahead.h). An earlier price is not
// believed there, and would be another plan here.
//
// Answers are judged against what is kept, of a whole day the first that came:
//   disagrees   with more than a tenth of it: shifted by an hour or a day, or another market's
//   repeats     the day before, price by price: an old answer
//   constant    one price all day: zeros that stand there until the auction
// Such an answer, or such a day of it, is refused; what is kept counts until its day is over.
// Prices that the layout assumes (day_ahead_rows.h) are planned on, but their day is not whole: it
// is asked for again, and a later answer replaces them; said again after hours, they are believed.
#pragma once

#include <cstdint>
#include <iterator>
#include <span>

#include "edge/core/base/status.h"
#include "shared/host/day_ahead_rows.h"
#include "shared/outlook/outlook_plan.h"

namespace bess {

/// One that is kept.
struct KnownPrice {
  std::int64_t utc_s = 0;  ///< start of its quarter-hour; 0 = none
  std::int64_t received_utc_s = 0;
  std::int32_t centi_eur_per_mwh = 0;
  bool is_assumed = false;
};

class DayAheadBook {
 public:
  static constexpr int kPricesMax = 512;  ///< more than five days

  /// An answer. kOk: something of yesterday, today or tomorrow is kept of it; kNoRow: nothing of
  /// these days; kImplausible: refused as above, in whole or in a day; kDoubtfulUnit: no price of a
  /// day reaches 5 EUR/MWh.
  Status take(std::span<const DayAheadDay> days, std::int64_t now_utc_s);
  /// As an earlier run kept it. False for what no run keeps.
  bool restore(const KnownPrice& price);

  /// The days around an instant with what was known of them then.
  [[nodiscard]] OutlookDays days_at(std::int64_t utc_s) const;
  /// Whether every quarter-hour of [from, until) had come by `now_utc_s`, none of them assumed.
  [[nodiscard]] bool has_all(std::int64_t from_utc_s, std::int64_t until_utc_s,
                             std::int64_t now_utc_s) const;
  /// How many prices were kept since the start: the same, and the file still holds all of them.
  [[nodiscard]] std::uint32_t changes() const { return changes_; }
  /// For the file: those with utc_s == 0 are none, those that are assumed are asked for again.
  [[nodiscard]] std::span<const KnownPrice> prices() const { return prices_; }

 private:
  struct Answer : OutlookDays {
    bool is_assumed[std::size(OutlookDays{}.day_ahead_centi)] = {};
  };
  [[nodiscard]] const KnownPrice* find(std::int64_t utc_s, std::int64_t now_utc_s) const;
  [[nodiscard]] bool disagrees(const Answer& answer, std::int64_t now_utc_s) const;
  [[nodiscard]] bool repeats_day_before(const OutlookDays& answer, int day,
                                        std::int64_t now_utc_s) const;
  void keep_day(const Answer& answer, int day, std::int64_t now_utc_s);

  std::uint32_t changes_ = 0;
  KnownPrice prices_[kPricesMax] = {};  ///< at the quarter-hour's number modulo the size
};

/// From when on tomorrow's prices count as known: 13:00 local time of the day that begins then.
std::int64_t publication_utc_s(std::int64_t today_midnight_utc_s);

}  // namespace bess
