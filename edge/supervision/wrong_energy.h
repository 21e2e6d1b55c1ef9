// How much energy has flowed against or beyond orders, whatever its rhythm: a count of bad readings
// forgives a fault that is rare enough, a sum of energy does not. A one-sided CUSUM over days, in
// shares of the capacity:
//
//   S <- max(0, S + wrong power * time - a * time),  told from h / 4 on, a trip at h = 20 %
//
//   a = 2.5 % a day   what is taken for wrong of an honest battery
//
// A fault that moves r a day is found before it has moved h r / (r - a), and what one reading adds:
// that is less than twice h for any r from 5 % a day on. One of less than a is never found.
#pragma once

#include <algorithm>
#include <cstdint>

#include "edge/supervision/response.h"

namespace bess {

class WrongEnergy {
 public:
  static constexpr std::int64_t kFoundE6 = 200'000;
  static constexpr std::int64_t kToldE6 = kFoundE6 / 4;
  static constexpr std::int64_t kForgivenE6PerDay = 25'000;

  /// A reading that was judged; `wrong_w`: against or beyond its order, since the one before.
  void add(const Response& now, std::int64_t wrong_w, std::int64_t capacity_wh) {
    const std::int64_t seconds =
        judged_s_ == 0 ? 0 : std::max<std::int64_t>(now.steady_s - judged_s_, 0);
    const std::int64_t known_s = judged_s_ == 0 ? kKnownS : std::min(seconds, kKnownS);
    const std::int64_t wrong_ws =
        std::min(wrong_w, kWattsMax) * std::min<std::int64_t>(known_s, now.order_age_s);
    const std::int64_t forgiven_e9 = kForgivenE6PerDay * 1'000 * std::min(seconds, kDayS) / kDayS;
    const std::int64_t wrong_e9 = wrong_ws * 1'000'000 / capacity_wh * 10 / 36;
    sum_e9_ = std::clamp<std::int64_t>(sum_e9_ + wrong_e9 - forgiven_e9, 0, kMostE9);
    judged_s_ = now.steady_s;
  }
  [[nodiscard]] bool is_found() const { return share_e6() >= kFoundE6; }
  /// Of the capacity.
  [[nodiscard]] std::int32_t share_e6() const { return static_cast<std::int32_t>(sum_e9_ / 1'000); }
  /// Of an earlier run, by its log, in place of what was recalled of it.
  void restore(std::int32_t share_e6) {
    sum_e9_ = std::clamp<std::int64_t>(std::int64_t{share_e6} * 1'000, 0, kMostE9);
  }

 private:
  static constexpr std::int64_t kMostE9 = 2 * kFoundE6 * 1'000;
  static constexpr std::int64_t kDayS = 86'400;
  static constexpr std::int64_t kWattsMax = 100'000'000;
  /// Of longer ago a reading says nothing: its watchdog may have ended the order meanwhile.
  static constexpr std::int64_t kKnownS = 300;

  std::int64_t sum_e9_ = 0;
  std::int64_t judged_s_ = 0;  ///< when the newest reading was; 0 = none yet
};

}  // namespace bess
