// Energy balance: SoC change against measured energy. One reading of a coarse SoC is weak evidence,
// two hours are strong. Every span of the newest intervals that ends now is judged, short and long,
// charging and discharging together, against the noise due to the SoC resolution.
//
// An interval i between two readings has energy e_i (measured) and SoC change s_i, both in 1e-4 of
// the capacity. With k the share of the energy that arrives, s_i = k e_i + u_i - u_(i-1), where u
// is the independent error of one SoC reading. Over a span
//
//   sum (K e_i - s_i) e_i  =  (K - k) sum e_i^2  -  sum u_i (e_i - e_(i+1))
//
// so that k < K is shown when the left side exceeds z sigma_u sqrt(sum (e_i - e_(i+1))^2), with e =
// 0 outside the span. A single interval is never sufficient: the finding must hold without its
// largest contribution, else a recalibration of the SoC would cause a finding.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "edge/core/supervision/response.h"
#include "shared/units_and_limits.h"

namespace bess {

// Cumulative energy over the age that an SoC may have: a reading shows the SoC at some instant
// within a window that ends now; its energy is between the minimum and maximum of that window.

/// In watt-seconds, charging positive.
struct EnergyRange {
  std::int64_t least_ws = 0;
  std::int64_t most_ws = 0;

  /// From an instant of `before` to one of this.
  [[nodiscard]] constexpr EnergyRange since(const EnergyRange& before) const {
    return {least_ws - before.most_ws, most_ws - before.least_ws};
  }
  /// Energy that flowed for every choice of instants, signed; 0: possibly none.
  [[nodiscard]] constexpr std::int64_t surely_ws() const {
    return least_ws > 0 ? least_ws : std::min<std::int64_t>(most_ws, 0);
  }
};

class EnergyPath {
 public:
  /// Two for each reading and each cut; a window is 700 s at most.
  static constexpr std::size_t kPoints = 64;

  /// The energy before this is unknown.
  void begin(std::int64_t steady_s) {
    count_ = 0;
    push({steady_s, newest().energy_ws});
  }
  /// `power_w` since the previous point.
  void add(std::int64_t steady_s, std::int32_t power_w) {
    const std::int64_t seconds = std::max<std::int64_t>(steady_s - newest().steady_s, 0);
    if (seconds == 0) return;
    push({steady_s, newest().energy_ws + std::int64_t{power_w} * seconds});
  }
  [[nodiscard]] std::int64_t energy_ws() const { return newest().energy_ws; }

  /// Between then and now. Forgotten time counts at up to `power_w_max`, in either direction.
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

// Wrong energy: energy against or beyond orders, whatever its pattern. A leaky count forgives a
// rare fault; a sum of energy does not. One-sided CUSUM over days, in shares of the capacity:
//
//   S <- max(0, S + wrong power * time - a * time);  reported from h / 4, trip at h = 20 %
//
//   a = 2.5 % per day   apparent wrong energy of a healthy battery
//
// A fault of r per day is found before it moves h r / (r - a) plus one reading: less than
// twice h for any r from 5 % per day. A fault below a is never found.

class WrongEnergy {
 public:
  static constexpr std::int64_t kFoundE6 = 200'000;
  static constexpr std::int64_t kReportedE6 = kFoundE6 / 4;
  static constexpr std::int64_t kForgivenE6PerDay = 25'000;

  /// A judged reading; `wrong_w`: power against or beyond its order, since the previous one.
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
  /// Share of the capacity.
  [[nodiscard]] std::int32_t share_e6() const { return static_cast<std::int32_t>(sum_e9_ / 1'000); }
  /// Value of an earlier run, from its log; replaces the recalled one.
  void restore(std::int32_t share_e6) {
    sum_e9_ = std::clamp<std::int64_t>(std::int64_t{share_e6} * 1'000, 0, kMostE9);
  }

 private:
  static constexpr std::int64_t kMostE9 = 2 * kFoundE6 * 1'000;
  static constexpr std::int64_t kWattsMax = 100'000'000;
  /// Longer gaps are unknown: the watchdog may have ended the order.
  static constexpr std::int64_t kKnownS = 300;

  std::int64_t sum_e9_ = 0;
  std::int64_t judged_s_ = 0;  ///< time of the newest reading; 0 = none yet
};

/// Result of two consecutive readings of the battery.
struct EnergyInterval {
  enum class Kind : std::uint8_t {
    kUnknown,  ///< not under control throughout, too long, excused, or hardly any power
    kFlowing,
    kResting,  ///< 0 W ordered, and almost none measured at both ends
  };
  Kind kind = Kind::kUnknown;
  std::int16_t energy_e4 = 0;  ///< measured; charging is positive
  /// The same with the largest permitted delay of power and SoC: smaller after a change of the
  /// order, of opposite sign after a reversal.
  std::int16_t late_energy_e4 = 0;
  std::int16_t soc_e4 = 0;  ///< increase of the SoC
  std::int16_t seconds = 0;
  std::int32_t power_w = 0;  ///< at the end of the interval
};

class EnergyBalance {
 public:
  static constexpr std::size_t kIntervals = 60;  ///< two hours

  /// Findings over the spans. Shares in percent of the measured energy; 0 = no finding.
  struct Findings {
    /// Beyond any healthy battery: less than 40 %, more than 250 %.
    bool contradicts = false;
    /// Share of the energy that shows in the SoC: below 70 or above 150 for a finding.
    std::int16_t share_percent = 0;
    /// Loss at 0 W or in addition to orders (negative: gain), measured or not.
    std::int32_t rest_loss_w = 0;
  };

  explicit EnergyBalance(const ResponseSettings& settings) : settings_(settings) {}

  /// The newest interval; `soc_span_e4`: possible difference of two readings of the same SoC.
  void observe(const EnergyInterval& interval, std::int32_t soc_span_e4);
  /// The time between the previous and the next interval is unknown.
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

  ResponseSettings settings_;
  std::array<EnergyInterval, kIntervals> intervals_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  Findings findings_;
};

// Sparse SoC: the device updates it only every few minutes ([response] soc_refresh_s of its map).
// Each reading is of an unknown instant since then, and orders reverse in the same time, so that
// the energy error of one interval may exceed the interval. Therefore
//   - a reading of the SoC has a range of energies, narrower where the SoC has just changed;
//   - the SoC counts as constant only if energy flowed for every choice of instants;
//   - readings are combined until the certain energy is three quarters of the total, mostly in one
//     direction: then they are one interval of EnergyBalance. If orders reverse more often, there
//     is no result.

class SparseSocCheck {
 public:
  static constexpr std::int32_t kUsualRefreshS = 60;  ///< maximum age of a normal SoC

  explicit SparseSocCheck(const ResponseSettings& settings) : settings_(settings) {}

  [[nodiscard]] bool is_seldom() const { return settings_.band.soc_refresh_s > kUsualRefreshS; }

  /// The time before this reading is unknown.
  void begin(const Response& now);
  /// `power_before_w`: power at the previous reading, until this one's order.
  void note_power(const Response& now, std::int32_t power_before_w);
  /// Must follow `note_power` of the same reading.
  void observe(const Response& now);

  /// Since the previous reading.
  [[nodiscard]] EnergyRange change() const { return now_.energy.since(before_.energy); }
  /// Certain energy since the SoC last changed, signed.
  [[nodiscard]] std::int64_t still_ws() const {
    return now_.energy.since(changed_.energy).surely_ws();
  }
  [[nodiscard]] std::int64_t still_s() const { return now_.steady_s - changed_.steady_s; }
  [[nodiscard]] std::int32_t still_readings() const { return still_readings_; }

  /// Combined readings.
  struct Interval {
    std::int64_t energy_ws = 0;
    std::int64_t surely_ws = 0;
    std::int32_t soc_e4 = 0;  ///< increase of the SoC
    std::int64_t seconds = 0;
  };
  /// False: not enough yet. The next interval begins where this one ends.
  bool take_interval(Interval& interval);
  /// The combined readings give no result: too long, or excused.
  [[nodiscard]] bool is_too_long() const;
  void restart_interval() { from_ = now_; }
  void restart_standstill() { changed_ = now_, still_readings_ = 0; }

 private:
  /// A reading, with the energy range of its SoC.
  struct Reading {
    std::int64_t steady_s = 0;
    std::int32_t soc_e4 = 0;
    EnergyRange energy{};
    std::int64_t energy_ws = 0;
    std::int64_t moved_ws = 0;  ///< both directions added
  };

  [[nodiscard]] Reading reading_of(const Response& now, std::int64_t refreshed_after_s) const;

  ResponseSettings settings_;
  EnergyPath path_;
  std::int64_t moved_ws_ = 0;
  std::int64_t noted_s_ = 0;
  Reading now_, before_;
  Reading changed_;  ///< the last at which the SoC changed
  Reading from_;     ///< start of the interval
  std::int32_t still_readings_ = 0;
};

}  // namespace bess
