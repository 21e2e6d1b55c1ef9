// Meter check: compares grid power with the steps of the battery. The controller steps its battery
// by kilowatts every few cycles, and grid = house + battery: each step must show on the meter. It
// detects a meter that is frozen, inverted, late, on another phase or of a wrong ratio. Pure
// integers, updated with every pair of readings.
//
// Only settled readings are compared: the last under one order with the first under the next,
// `settle_s` after it, so that neither a ramp nor a lagging register counts. The house load varies
// too, by kilowatts at times. Therefore
//   - the shortfall of a step must exceed 40 % of it, and twice the recent variation of the house
//     between readings under one order (its second largest change, fading);
//   - one such step is a doubt, not a finding. The response is 0 W until the next tick: the same
//     experiment in reverse, at an instant independent of the house;
//   - a contradiction adds 3 points, a matching step or ten minutes remove 1: four in a row are a
//     finding, and a meter that is wrong at every second or third step is found too;
//   - ratios of 0.6 to 1, and above 1, are found by sums over the last steps: the error exceeds a
//     quarter and correlates with the step (above 0.7), which the house does not do for long;
//   - until then limits must also hold for the ratio of each of the last three steps
//     (`possible_ratios`, 0.45 to 2, for 20 minutes): no finding, and a cost only near a limit;
//   - a step that shows later, at constant battery power, is attributed to the meter, and so is a
//     change of sign.
//   trusted --four contradictions, or wrong in sum--> paused --pause over--> tested
//      ^                                                ^                      |  |
//      |                                                +---contradiction------+  |
//      +-----------------------six steps that agree, alone and in sum-------------+
//
// A finding ends by itself, because a remote operator cannot verify a meter and a resting battery
// gives no evidence. After a pause (10 min, doubling to 6 h) the meter is tested at an eighth of
// the power, in every second cycle, as far as prices require power, and only until each step has
// shown. Six steps that agree, alone and in sum, end the finding; a contradiction starts the next
// pause. The length of the pause resets after a day without a finding.
//
// Not detected: an offset (see HouseWatch), and errors while the battery rests. A device that
// regulates the grid power (a second battery, PV curtailment) hides the steps: `judged = false`. A
// wrong battery power looks the same: one of the two is wrong, and neither is reliable.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "edge/core/control/site_types.h"

namespace bess {

// House watch: is the load computed from meter and battery possible? House = grid - battery; below
// zero it generates, at most its PV power. An inverted meter or battery, an offset or another phase
// show as "house -631 W". Reported only: with undeclared PV panels a stop would disable the battery
// in sunshine.

/// Error of both meters, plus a share of the battery's power, which is read slightly earlier.
inline constexpr std::int64_t kHouseErrorW = 200;
inline constexpr std::int64_t kHouseErrorShare = 20;

/// `pv_w_max`: maximum power of the PV behind the meter; kAnyPowerW: unknown.
constexpr bool is_plausible_house(std::int32_t grid_w, std::int32_t battery_w,
                                  std::int32_t pv_w_max) {
  if (pv_w_max == kAnyPowerW) return true;
  const std::int64_t battery_magnitude_w =
      std::max<std::int64_t>(battery_w, -std::int64_t{battery_w});
  const std::int64_t error_w = kHouseErrorW + battery_magnitude_w / kHouseErrorShare;
  return std::int64_t{grid_w} - battery_w >= -std::int64_t{pv_w_max} - error_w;
}

class HouseWatch {
 public:
  /// Consecutive readings that begin and end it: one may fall into a ramp.
  static constexpr std::int32_t kReadings = 4;

  void observe(bool is_plausible) {
    if (is_plausible != is_implausible_) {
      readings_ = 0;
    } else if (++readings_ >= kReadings) {
      is_implausible_ = !is_plausible;
      readings_ = 0;
    }
  }
  [[nodiscard]] bool is_implausible() const { return is_implausible_; }

 private:
  bool is_implausible_ = false;
  std::int32_t readings_ = 0;  ///< consecutive readings to the contrary
};

struct MeterCheckSettings {
  bool judges = true;
  std::int32_t power_w = 4'000;  ///< rated power of the battery
  std::int32_t settle_s = 20;    ///< from an order until the power has settled
};

inline constexpr std::int32_t kTrueRatio = 1'000;  ///< in permille

/// Ratio of meter to real power in permille, from the last steps.
struct MeterRatios {
  std::int32_t least_permille = kTrueRatio;  ///< 1000 or less
  std::int32_t most_permille = kTrueRatio;   ///< 1000 or more
};

/// Order that the battery follows while meter and battery are read.
struct ObservedOrder {
  bool is_driven = false;  ///< false: the battery is in its own mode
  std::int32_t age_s = 0;  ///< since this power was ordered
};

struct MeterCheckReading {
  std::int64_t utc_s = 0;
  std::int32_t grid_w = 0;
  std::int32_t battery_w = 0;
  ObservedOrder order{};
};

class MeterCheck {
 public:
  explicit MeterCheck(const MeterCheckSettings& settings) : settings_(settings) {}

  void observe(const MeterCheckReading& now);

  /// Result of an earlier run.
  void restore(const MeterTrust& trust) { trust_ = trust; }
  [[nodiscard]] const MeterTrust& trust() const { return trust_; }

  /// Limits must hold for these ratios too: a step that shows too little may be due to the meter as
  /// well as the house, and a limit could be exceeded before this is known.
  [[nodiscard]] MeterRatios possible_ratios(std::int64_t now_utc_s) const;

  /// Finding: the meter's value must not be used.
  [[nodiscard]] bool is_mismatch() const { return trust_.is_mismatch; }
  /// Maximum power to order, of either sign; kAnyPowerW: no finding.
  [[nodiscard]] std::int32_t power_w_max(std::int64_t now_utc_s) const;

 private:
  /// A step between two settled readings with different orders, in the direction of the battery's
  /// step.
  struct Step {
    std::int64_t size_w;   ///< of the battery, above 0
    std::int64_t along_w;  ///< of the meter, positive: same direction
  };

  enum class State : std::uint8_t { kTrusted, kPaused, kTested };

  /// A battery step that did not show, signed.
  struct UnansweredStep {
    std::int64_t power_w = 0;
    std::int64_t utc_s = 0;
  };
  struct ObservedRatio {
    std::int64_t utc_s = 0;
    std::int32_t permille = kTrueRatio;
  };

  void fade_doubt(std::int64_t utc_s);
  void note_house(const MeterCheckReading& now);
  void judge_step(const MeterCheckReading& now);
  void judge_excess(const MeterCheckReading& now);
  void note_ratio(const Step& step, std::int64_t utc_s);
  [[nodiscard]] Step step_to(const MeterCheckReading& now) const;
  [[nodiscard]] bool turns_around(std::int64_t from_w, std::int64_t to_w) const;
  [[nodiscard]] bool is_late_answer(std::int64_t house_step_w, std::int64_t utc_s) const;
  [[nodiscard]] bool contradicts(const Step& step) const;
  void on_contradiction(const MeterCheckReading& now, std::int32_t points);
  void judge_test(const Step& step, std::int64_t utc_s);
  void add_to_sums(const Step& step);
  [[nodiscard]] bool is_wrong_ratio() const;
  [[nodiscard]] State state_at(std::int64_t now_utc_s) const;
  void find(std::int64_t utc_s);

  MeterCheckSettings settings_;
  MeterTrust trust_;
  std::optional<MeterCheckReading> before_;  ///< last settled reading
  std::int64_t noise_w_ = 0;                 ///< second largest recent change of the house, fading
  std::int64_t largest_move_w_ = 0;
  std::int64_t faded_utc_s_ = 0;  ///< last time-based decay
  std::optional<UnansweredStep> missed_;
  std::int64_t test_power_until_utc_s_ = 0;
  std::array<ObservedRatio, 3> shown_{};  ///< ratios of the last steps
};

}  // namespace bess
