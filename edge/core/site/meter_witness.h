// Does the meter at the connection see what the battery does? The controller steps its battery by
// kilowatts every few cycles, and grid = house + battery: each such step must show on the meter.
// One that is frozen, inverted, on another phase, late or of a wrong ratio would be believed
// else. Pure integers, fed with every pair of readings.
//
// Only what has settled is compared: the last readings under one order with the first ones under
// the next, `settle_s` after it, so that neither a ramp nor a register that lags counts. The
// house moves meanwhile, by kilowatts at times. Therefore
//   - what is missing of a step must be more than 40 % of it, and more than twice what the house
//     itself moves by lately, between readings under one order (its second largest move, fading);
//   - one such step is a doubt and no finding. It is answered at once by 0 W until the next tick,
//     which is the same experiment again, backwards, at an instant that the house did not choose;
//   - contradictions weigh 3, what follows forgives 1, and so do ten minutes: four in a row are a
//     finding, and a meter that lies at every other or third step is found as well;
//   - ratios between 0.6 and 1, and above, are found by the sums over the last steps: the error
//     is more than a quarter and goes with the step (correlation above 0.7), which the house's
//     own moves do not do for long;
//   - until that is known, limits have to hold by the ratio of each of the last three steps as well
//     (`possible_ratios`, 0.45 to 2, for 20 minutes): no finding, and it costs only near a limit;
//   - a step that shows on the meter later, with the battery standing still, is the meter's and
//     not the house's, and so is a sign that turns around.
//   trusted --four contradictions, or wrong in sum--> paused --pause over--> tested
//      ^                                                ^                      |  |
//      |                                                +---contradiction------+  |
//      +-----------------------six steps that agree, alone and in sum-------------+
//
// A finding ends by itself, for no person can see from afar either whether a meter is right, and
// a battery that rests gives no evidence: after a pause (10 min, doubling to 6 h) it is tested
// with an eighth of the power, in every other cycle, as far as prices ask for any, and only until
// each step has shown. Six steps that agree, alone and in sum, end it; a contradiction is the
// next pause. The pause keeps its length until a day without a finding: it cannot flap.
//
// What it cannot see: an offset (steps are right: HouseWatch looks at the level), a meter that
// lies while the battery rests. Something else that holds the grid at a value (a second battery,
// curtailed sun) takes the steps away: `judged = false`. A battery whose measured power is not
// true looks the same: one of the two is wrong, and neither may be relied on.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "edge/core/control/site_types.h"

namespace bess {

// Is the load that meter and battery leave for the house one that a house can have? House = grid
// - battery; below zero it generates, and no more than its panels can. An inverted meter or
// battery, an offset, a meter on another phase show as "house -631 W". Told, not acted on:
// whoever has panels and has not said so would lose his battery to the sun.

/// Of both meters together, with that much of the battery's power besides: it is read a moment
/// earlier than the grid.
inline constexpr std::int64_t kHouseErrorW = 200;
inline constexpr std::int64_t kHouseErrorShare = 20;

/// `pv_w_max`: what the panels behind the meter can give; kAnyPowerW: not known.
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
  /// Readings in a row that begin and end it: one falls into a ramp.
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
  std::int32_t readings_ = 0;  ///< in a row that say otherwise
};

struct MeterWitnessSettings {
  bool judges = true;
  std::int32_t power_w = 4'000;  ///< rated, of the battery
  std::int32_t settle_s = 20;    ///< from an order to the power that answers it
};

inline constexpr std::int32_t kTrueRatio = 1'000;  ///< in permille

/// Of what the meter shows to what flows, as its last steps have shown it, in permille.
struct MeterRatios {
  std::int32_t least_permille = kTrueRatio;  ///< 1000 or less
  std::int32_t most_permille = kTrueRatio;   ///< 1000 or more
};

/// The order that the battery follows while meter and battery are read.
struct SeenOrder {
  bool is_driven = false;  ///< false: its own mode, which goes any way
  std::int32_t age_s = 0;  ///< since its power was ordered
};

struct WitnessReading {
  std::int64_t utc_s = 0;
  std::int32_t grid_w = 0;
  std::int32_t battery_w = 0;
  SeenOrder order{};
};

class MeterWitness {
 public:
  explicit MeterWitness(const MeterWitnessSettings& settings) : settings_(settings) {}

  void observe(const WitnessReading& now);

  /// What an earlier run had found out.
  void restore(const MeterTrust& trust) { trust_ = trust; }
  [[nodiscard]] const MeterTrust& trust() const { return trust_; }

  /// Limits must hold by these as well: a step that shows too little is as likely the meter's as
  /// the house's, and long before either is known, a limit has been passed.
  [[nodiscard]] MeterRatios possible_ratios(std::int64_t now_utc_s) const;

  /// Found: the meter's value must not decide.
  [[nodiscard]] bool is_mismatch() const { return trust_.is_mismatch; }
  /// Power, of either sign, that may be ordered as things stand; kAnyPowerW: nothing is wrong.
  [[nodiscard]] std::int32_t power_w_max(std::int64_t now_utc_s) const;

 private:
  /// Between two settled readings with an order's change between them; along the battery's step.
  struct Step {
    std::int64_t size_w;   ///< of the battery, above 0
    std::int64_t along_w;  ///< of the meter, positive: the same way
  };

  enum class State : std::uint8_t { kTrusted, kPaused, kTested };

  /// A step of the battery that did not show, with its sign.
  struct MissedStep {
    std::int64_t power_w = 0;
    std::int64_t utc_s = 0;
  };
  struct ShownRatio {
    std::int64_t utc_s = 0;
    std::int32_t permille = kTrueRatio;
  };

  void fade_doubt(std::int64_t utc_s);
  void note_house(const WitnessReading& now);
  void judge_step(const WitnessReading& now);
  void judge_excess(const WitnessReading& now);
  void note_ratio(const Step& step, std::int64_t utc_s);
  [[nodiscard]] Step step_to(const WitnessReading& now) const;
  [[nodiscard]] bool turns_around(std::int64_t from_w, std::int64_t to_w) const;
  [[nodiscard]] bool is_late_answer(std::int64_t house_step_w, std::int64_t utc_s) const;
  [[nodiscard]] bool contradicts(const Step& step) const;
  void on_contradiction(const WitnessReading& now, std::int32_t points);
  void judge_test(const Step& step, std::int64_t utc_s);
  void end_test(std::int64_t utc_s);
  void add_to_sums(const Step& step);
  [[nodiscard]] bool is_wrong_ratio() const;
  [[nodiscard]] std::int32_t test_power_w(std::int64_t now_utc_s) const;
  [[nodiscard]] State state_at(std::int64_t now_utc_s) const;
  void find(std::int64_t utc_s);

  MeterWitnessSettings settings_;
  MeterTrust trust_;
  std::optional<WitnessReading> before_;  ///< the last settled one
  std::int64_t noise_w_ = 0;              ///< the house's second largest move of late, fading
  std::int64_t largest_move_w_ = 0;
  std::int64_t faded_utc_s_ = 0;  ///< when time last forgave
  std::optional<MissedStep> missed_;
  std::int64_t retreat_until_utc_s_ = 0;
  std::array<ShownRatio, 3> shown_{};  ///< by the last steps
};

}  // namespace bess
