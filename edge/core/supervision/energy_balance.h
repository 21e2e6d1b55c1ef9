// Does the state of charge move as the measured power explains? One reading of a coarse state of
// charge says little, two hours of them much: every span of the newest intervals that ends now is
// judged, short ones and long ones, charging and discharging together, against the noise that the
// resolution of the SoC alone makes.
//
// An interval i between two readings brings energy e_i (measured) and a change of the SoC s_i, both
// in 1e-4 of the capacity. With k the share of the energy that arrives, s_i = k e_i + u_i -
// u_(i-1), where u is the error of one reading of the SoC, independent of the others. Over a span
//
//   sum (K e_i - s_i) e_i  =  (K - k) sum e_i^2  -  sum u_i (e_i - e_(i+1))
//
// so that k < K is shown when the left side exceeds z sigma_u sqrt(sum (e_i - e_(i+1))^2), with e =
// 0 outside the span. A single interval is no evidence, however far it lies off: the finding must
// hold without the one that speaks for it most, or a battery that sets its count right would be
// accused.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "edge/core/supervision/response.h"
#include "shared/units_and_limits.h"

namespace bess {

// How much energy had flowed by when, for as long as a state of charge may be old: a reading of it
// tells of some instant within a window that ends now, and the energy of that instant lies between
// the least and the most of it.

/// In watt-seconds, charging positive.
struct EnergyRange {
  std::int64_t least_ws = 0;
  std::int64_t most_ws = 0;

  /// From an instant of `before` to one of this.
  [[nodiscard]] constexpr EnergyRange since(const EnergyRange& before) const {
    return {least_ws - before.most_ws, most_ws - before.least_ws};
  }
  /// That flowed whichever the instants were, with its sign; 0: it may have been none.
  [[nodiscard]] constexpr std::int64_t surely_ws() const {
    return least_ws > 0 ? least_ws : std::min<std::int64_t>(most_ws, 0);
  }
};

class EnergyPath {
 public:
  static constexpr std::size_t kPoints =
      64;  ///< two for each reading and each cut; a window is 620 s at most

  /// What flowed before is not known.
  void begin(std::int64_t steady_s) {
    count_ = 0;
    push({steady_s, newest().energy_ws});
  }
  /// `power_w` since the point before.
  void add(std::int64_t steady_s, std::int32_t power_w) {
    const std::int64_t seconds = std::max<std::int64_t>(steady_s - newest().steady_s, 0);
    if (seconds == 0) return;
    push({steady_s, newest().energy_ws + std::int64_t{power_w} * seconds});
  }
  [[nodiscard]] std::int64_t energy_ws() const { return newest().energy_ws; }

  /// Between then and now. What is not remembered went at most at `power_w_max`, either way.
  [[nodiscard]] EnergyRange since(std::int64_t from_s, std::int32_t power_w_max) const {
    EnergyRange range{newest().energy_ws, newest().energy_ws};
    const auto include = [&range](std::int64_t energy_ws) {
      range.least_ws = std::min(range.least_ws, energy_ws);
      range.most_ws = std::max(range.most_ws, energy_ws);
    };
    for (std::size_t i = 1; i < count_; ++i) {
      const Point& later = back(i - 1);
      const Point& earlier = back(i);
      if (later.steady_s <= from_s) return range;
      const std::int64_t seconds = later.steady_s - earlier.steady_s;
      const std::int64_t left_s = std::max(from_s, earlier.steady_s) - earlier.steady_s;
      include(earlier.energy_ws + (later.energy_ws - earlier.energy_ws) * left_s / seconds);
    }
    const std::int64_t forgotten_s = std::max<std::int64_t>(back(count_ - 1).steady_s - from_s, 0);
    const std::int64_t oldest_ws = back(count_ - 1).energy_ws;
    include(oldest_ws - power_w_max * forgotten_s);
    include(oldest_ws + power_w_max * forgotten_s);
    return range;
  }

 private:
  struct Point {
    std::int64_t steady_s = 0;
    std::int64_t energy_ws = 0;
  };

  void push(const Point& point) {
    next_ = (next_ + 1) % kPoints;
    points_[next_] = point;
    count_ = std::min(count_ + 1, kPoints);
  }
  /// 0 is the newest.
  [[nodiscard]] const Point& back(std::size_t i) const {
    return points_[(next_ + kPoints - i) % kPoints];
  }
  [[nodiscard]] const Point& newest() const { return points_[next_]; }

  std::array<Point, kPoints> points_{};
  std::size_t next_ = 0;
  std::size_t count_ = 1;
};

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
    const std::int64_t forgiven_e9 =
        kForgivenE6PerDay * 1'000 * std::min(seconds, kSecondsPerDay) / kSecondsPerDay;
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
  static constexpr std::int64_t kWattsMax = 100'000'000;
  /// Of longer ago a reading says nothing: its watchdog may have ended the order meanwhile.
  static constexpr std::int64_t kKnownS = 300;

  std::int64_t sum_e9_ = 0;
  std::int64_t judged_s_ = 0;  ///< when the newest reading was; 0 = none yet
};

/// What two readings of the battery, one after the other, say together.
struct EnergyInterval {
  enum class Kind : std::uint8_t {
    kUnknown,  ///< not under control throughout, too long, excused, or hardly any power
    kFlowing,
    kResting,  ///< 0 W were ordered, and next to nothing was measured at both ends
  };
  Kind kind = Kind::kUnknown;
  std::int16_t energy_e4 = 0;  ///< measured; charging is positive
  /// The same, had the battery followed its order, and the SoC the battery, as late as they may:
  /// less where the order has changed, and of the other sign after a reversal.
  std::int16_t late_energy_e4 = 0;
  std::int16_t soc_e4 = 0;  ///< by how much the SoC rose
  std::int16_t seconds = 0;
  std::int32_t power_w = 0;  ///< measured at its end
};

struct EnergyBalanceSettings {
  std::int32_t capacity_wh = 8'000;
  std::int32_t noise_w = 200;  ///< own consumption, and error of the meter
  bool charges_by_itself = false;
};

class EnergyBalance {
 public:
  static constexpr std::size_t kIntervals = 60;  ///< two hours

  /// What the spans show. Shares in percent of the measured energy; 0: nothing is found.
  struct Findings {
    bool contradicts =
        false;  ///< beyond what any honest battery does: less than 40 %, more than 250 %
    std::int16_t share_percent =
        0;  ///< of the energy shows in the SoC: below 70 or above 150 where it is found
    std::int32_t rest_loss_w = 0;  ///< at 0 W, or besides its orders, it loses that much (negative:
                                   ///< gains), measured or not
  };

  explicit EnergyBalance(const EnergyBalanceSettings& settings) : settings_(settings) {}

  /// The newest interval; `soc_span_e4`: how far two readings of the same SoC may lie apart.
  void observe(const EnergyInterval& interval, std::int32_t soc_span_e4);
  /// Between the intervals before and the next nothing is known.
  void interrupt() { add(EnergyInterval{}); }

  [[nodiscard]] const Findings& findings() const { return findings_; }

 private:
  void add(const EnergyInterval& interval);
  void judge_flow(std::int64_t soc_variance);
  void judge_rest(std::int64_t soc_variance);
  void judge_drift(std::int64_t soc_variance);
  /// 0 is the newest.
  [[nodiscard]] const EnergyInterval& back(std::size_t i) const {
    return intervals_[(next_ + kIntervals - 1 - i) % kIntervals];
  }

  EnergyBalanceSettings settings_;
  std::array<EnergyInterval, kIntervals> intervals_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  Findings findings_;
};

// A state of charge that its device brings up to date every few minutes, as its map says
// ([response] soc_refresh_s). Each reading of it is of some instant since then, and orders turn
// meanwhile: what the energy of an interval between two readings is off by may be more than the
// interval. So
//   - a reading of the SoC has a range of energies, not one; where the SoC has just changed, a
//     narrower one;
//   - it stands still only if energy has flowed whichever instants the readings are of;
//   - readings are put together until that is three quarters of what has flowed, most of it one
//     way: then they are one interval of EnergyBalance. Where orders turn more often than that,
//     nothing is said.

class SeldomSoc {
 public:
  static constexpr std::int32_t kUsualRefreshS = 60;  ///< as old as that is any

  explicit SeldomSoc(const ResponseSettings& settings) : settings_(settings) {}

  [[nodiscard]] bool is_seldom() const { return settings_.band.soc_refresh_s > kUsualRefreshS; }

  /// Nothing is known of what was before this reading.
  void begin(const Response& now);
  /// `power_before_w` at the reading before, until the order of this one.
  void note_power(const Response& now, std::int32_t power_before_w);
  /// After `note_power` of it.
  void observe(const Response& now);

  /// Since the reading before.
  [[nodiscard]] EnergyRange change() const { return now_.energy.since(before_.energy); }
  /// That has surely flowed since the SoC last changed, with its sign.
  [[nodiscard]] std::int64_t still_ws() const {
    return now_.energy.since(changed_.energy).surely_ws();
  }
  [[nodiscard]] std::int64_t still_s() const { return now_.steady_s - changed_.steady_s; }
  [[nodiscard]] std::int32_t still_readings() const { return still_readings_; }

  /// Readings that say enough together.
  struct Interval {
    std::int64_t energy_ws = 0;
    std::int64_t surely_ws = 0;
    std::int32_t soc_e4 = 0;  ///< by how much it rose
    std::int64_t seconds = 0;
  };
  /// False: not yet. The next one begins where this one ends.
  bool take_interval(Interval& interval);
  /// What has come together so far says nothing: it was too long, or is excused.
  [[nodiscard]] bool is_too_long() const;
  void restart_interval() { from_ = now_; }
  void restart_standstill() { changed_ = now_, still_readings_ = 0; }

 private:
  /// A reading, and of what energy its SoC may be.
  struct Reading {
    std::int64_t steady_s = 0;
    std::int32_t soc_e4 = 0;
    EnergyRange energy{};
    std::int64_t energy_ws = 0;
    std::int64_t moved_ws = 0;  ///< both ways together
  };

  [[nodiscard]] Reading reading_of(const Response& now, std::int64_t refreshed_after_s) const;

  ResponseSettings settings_;
  EnergyPath path_;
  std::int64_t moved_ws_ = 0;
  std::int64_t noted_s_ = 0;
  Reading now_, before_;
  Reading changed_;  ///< the last at which the SoC was another one than before
  Reading from_;     ///< with which the interval began
  std::int32_t still_readings_ = 0;
};

}  // namespace bess
