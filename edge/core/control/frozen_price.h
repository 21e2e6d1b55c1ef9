// Frozen price: the price does not change while its time stamps advance. First reported, later
// treated as no price. Pure integers.
//
// Longest constant correct prices, to the cent, measured on 23 November 2026 on Elia's data:
//   the 1,631 real minutes of 6 September 2024 and 8 April 2025: 19 minutes (22 between the rows
//     that a controller requests)
//   52,530 real settled quarter-hours of January 2023 to June 2025: 10 in a row (150.00, on
//     29 December 2024); 7 or more 26 times, 9 or more 8 times. The minutes converge to the settled
//     price, so a run of minutes is at most two times 14 minutes longer: under 3 hours
// Hence 30 minutes are reported, and 3 hours exceed any correct price. The thresholds for
// alternation between four values (RepeatedValues) are four times as long to report and 2.5 times
// as long to stop.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/fixed_point.h"
#include "shared/units_and_limits.h"

namespace bess {

// Alternation between a few values under new time stamps: a source that hangs and shows several of
// its last rows in turn. Pure integers.
//
// Longest stay of correct prices within four values, to the cent, measured on 23 November 2026 on
// Elia's data, every second minute, as a controller requests:
//   the 1,631 real minutes of 6 September 2024 and 8 April 2025   66 minutes
//   the 204,420 rebuilt minutes of January to May 2023            50 minutes
//   52,530 real settled quarter-hours of January 2023 to June     405 minutes, in December 2024
//   2025, as if every minute had shown them
// Five or more values count as a changing price.

class RepeatedValues {
 public:
  static constexpr std::size_t kValues = 4;

  /// `counted_s`: time since the previous row.
  constexpr void observe(std::int32_t value, std::int64_t counted_s) {
    now_s_ += counted_s;
    RecentValue* seen =
        std::find_if(begin(), end(), [&](const RecentValue& s) { return s.value == value; });
    if (seen == end() && count_ < kValues) {
      ++count_;
      if (count_ == 1) since_s_ = moved_s_ = now_s_;
    } else if (seen == end()) {  // the others are all values since the oldest
      seen = std::min_element(begin(), end(), [](const RecentValue& a, const RecentValue& b) {
        return a.last_s < b.last_s;
      });
      since_s_ = seen->last_s;
    }
    if (value != newest_) moved_s_ = now_s_;
    *seen = {value, now_s_};
    newest_ = value;
  }
  [[nodiscard]] constexpr std::int32_t newest() const { return newest_; }
  /// Time for which the newest value has not changed.
  [[nodiscard]] constexpr std::int64_t unchanged_for_s() const { return now_s_ - moved_s_; }
  /// Time for which there were at most four values.
  [[nodiscard]] constexpr std::int64_t lasted_s() const { return now_s_ - since_s_; }

 private:
  struct RecentValue {
    std::int32_t value = 0;
    std::int64_t last_s = 0;
  };

  constexpr RecentValue* begin() { return seen_.data(); }
  constexpr RecentValue* end() { return seen_.data() + count_; }

  std::array<RecentValue, kValues> seen_{};
  std::size_t count_ = 0;
  std::int64_t now_s_ = 0;
  std::int64_t since_s_ = 0;
  std::int64_t moved_s_ = 0;
  std::int32_t newest_ = 0;
};

struct FrozenPriceSettings {
  std::int32_t frozen_s = 1'800;  ///< reported as frozen after this time; 0 = never
  std::int32_t stop_s = 10'800;   ///< no price after this time; 0 = never
};

/// The newest row used by a decision, and for how long its price has not changed. Kept over
/// restarts: a restart does not reset the frozen state.
struct UnchangedPrice {
  std::int64_t minute_utc_s = 0;  ///< 0 = no row yet
  std::int32_t centi_eur_per_mwh = 0;
  std::int32_t unchanged_s = 0;  ///< from time stamp to time stamp, since the last change
};

class FrozenPrice {
 public:
  explicit constexpr FrozenPrice(const FrozenPriceSettings& settings) : settings_(settings) {}

  constexpr void restore(const UnchangedPrice& before) { price_ = before; }

  /// A row used by an earlier run, from its log, oldest first.
  constexpr void recall(std::int64_t minute_utc_s, std::int32_t centi_eur_per_mwh) {
    const bool goes_on = few_minute_utc_s_ > 0 && minute_utc_s > few_minute_utc_s_;
    const std::int64_t since_s = goes_on ? minute_utc_s - few_minute_utc_s_ : 0;
    // A price unchanged for this long was reported as frozen; now it has changed.
    const bool thaws = few_values_.unchanged_for_s() >= kStoodS;
    if (thaws && centi_eur_per_mwh != few_values_.newest()) few_values_ = RepeatedValues{};
    few_values_.observe(centi_eur_per_mwh, std::min(since_s, kCountedGapS));
    few_minute_utc_s_ = minute_utc_s;
  }

  /// The newest row used by a decision. An outage counts as one step: it neither resets the frozen
  /// state nor turns two equal rows hours apart into a frozen price.
  constexpr void observe(std::int64_t minute_utc_s, std::int32_t centi_eur_per_mwh) {
    recall(minute_utc_s, centi_eur_per_mwh);
    const bool is_same = price_.minute_utc_s > 0 && centi_eur_per_mwh == price_.centi_eur_per_mwh;
    const std::int64_t since_s = is_same ? minute_utc_s - price_.minute_utc_s : 0;
    const std::int64_t unchanged_for_s =
        is_same ? price_.unchanged_s + clamp_to<std::int64_t>(since_s, 0, kCountedGapS) : 0;
    price_ = {.minute_utc_s = minute_utc_s,
              .centi_eur_per_mwh = centi_eur_per_mwh,
              .unchanged_s =
                  static_cast<std::int32_t>(clamp_to<std::int64_t>(unchanged_for_s, 0, INT32_MAX))};
  }

  [[nodiscard]] constexpr const UnchangedPrice& price() const { return price_; }
  [[nodiscard]] constexpr bool is_frozen() const {
    const std::int64_t frozen_s = settings_.frozen_s;
    return frozen_s > 0 &&
           (price_.unchanged_s >= frozen_s || few_values_.lasted_s() >= 4 * frozen_s);
  }
  [[nodiscard]] constexpr bool is_no_price() const {
    const std::int64_t stop_s = settings_.stop_s;
    return stop_s > 0 && (price_.unchanged_s >= stop_s || few_values_.lasted_s() >= stop_s * 5 / 2);
  }

 private:
  static constexpr std::int64_t kStoodS = 1'800;  ///< longer than any run of correct minutes
  static constexpr std::int64_t kCountedGapS =
      2 * kSecondsPerStep;  ///< one step, and one that failed

  FrozenPriceSettings settings_;
  UnchangedPrice price_{};
  RepeatedValues few_values_;
  std::int64_t few_minute_utc_s_ = 0;  ///< newest row in few_values_; 0 = none
};

}  // namespace bess
