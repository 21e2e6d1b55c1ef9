// Commissioning input and findings of a sign check (commission.h), with meter and response time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "edge/core/base/response_band.h"
#include "edge/core/control/site_types.h"
#include "edge/device/battery/step_fit.h"
#include "edge/device/registers/codec.h"

namespace bess {

// Meter check during commissioning: the meter follows the battery's steps. Grid = house + battery:
// between two plateaus of the battery (at rest, driven, at rest, ...) the grid power must step by
// the same amount. The permitted error is the house's variation within a plateau.

enum class MeterVerdict : std::uint8_t {
  kNotAsked,  ///< no meter
  kFollows,
  kMismatch,  ///< the meter does not step with the battery
  kRestless,  ///< the house load varies more than the steps
};

class MeterProof {
 public:
  /// One settled reading of the current plateau.
  void add(std::int32_t battery_w, std::int32_t grid_w) {
    const std::int64_t house_w = std::int64_t{grid_w} - battery_w;
    if (now_.count > 0) {
      restless_w_ = std::max(
          restless_w_, std::max(house_w, house_before_w_) - std::min(house_w, house_before_w_));
    }
    house_before_w_ = house_w;
    ++now_.count;
    now_.battery_w += battery_w;
    now_.grid_w += grid_w;
  }

  /// The next order begins: the readings since the last one form a plateau.
  void end_plateau() {
    if (now_.count == 0) return;
    const Plateau plateau{
        .count = 1, .battery_w = now_.battery_w / now_.count, .grid_w = now_.grid_w / now_.count};
    if (before_.count > 0) judge(plateau);
    before_ = plateau;
    now_ = Plateau{};
  }

  /// More than half of the steps must agree: one may coincide with a house load step.
  [[nodiscard]] MeterVerdict verdict() const {
    if (steps_ == 0) return MeterVerdict::kNotAsked;
    if (2 * agreeing_ > steps_) return MeterVerdict::kFollows;
    return restless_w_ * 2 > smallest_step_w_ ? MeterVerdict::kRestless : MeterVerdict::kMismatch;
  }
  /// Share of the battery's steps shown by the meter.
  [[nodiscard]] std::int32_t percent() const {
    return squares_ == 0 ? 0 : static_cast<std::int32_t>(products_ * 100 / squares_);
  }

 private:
  struct Plateau {
    std::int64_t count = 0;
    std::int64_t battery_w = 0;
    std::int64_t grid_w = 0;
  };
  static constexpr std::int64_t kMeterErrorW = 50;

  void judge(const Plateau& now) {
    const std::int64_t battery_w = now.battery_w - before_.battery_w;
    const std::int64_t grid_w = now.grid_w - before_.grid_w;
    const std::int64_t size_w = std::max(battery_w, -battery_w);
    const std::int64_t error_w = std::max(grid_w - battery_w, battery_w - grid_w);
    ++steps_;
    smallest_step_w_ = std::min(smallest_step_w_, size_w);
    agreeing_ += error_w <= size_w / 5 + kMeterErrorW ? 1 : 0;
    products_ += grid_w * battery_w;
    squares_ += battery_w * battery_w;
  }

  Plateau now_;
  Plateau before_;
  std::int64_t house_before_w_ = 0;
  std::int64_t restless_w_ = 0;
  std::int64_t smallest_step_w_ = INT64_MAX;
  int steps_ = 0;
  int agreeing_ = 0;
  std::int64_t products_ = 0;
  std::int64_t squares_ = 0;
};

// Response time: does the battery settle as fast as its map says, for the controller's largest
// step? Judged by a small step and, if SoC and limits permit, a larger one of the same direction.
//
//   both     refused only if every possible fit of both is too slow, or the largest step itself was
//            seen to be late
//   one      refused only if it was late itself: the time of a larger step is reported as a range

struct StepResponseCriteria {
  ResponseBand response{};       ///< from the map
  std::int32_t rated_w = 4'000;  ///< largest order
  std::int32_t step_w_max = 8'000;

  /// Permitted error of the response to such a step, half of it each way.
  [[nodiscard]] std::int32_t band_w(std::int32_t step_w) const {
    return response.tolerance_of_w(rated_w, step_w / 2);
  }
};

struct StepResponseResult {
  bool has_two = false;      ///< steps of different size
  bool is_slow = false;      ///< certainly slower than [response] says
  bool is_doubtful = false;  ///< possibly slower
  StepDynamics dynamics{};   ///< without a ramp unless one is certain
  SecondsOfStep largest{};   ///< time of the largest step
  /// Settings with which it would pass; 0: no change.
  std::int32_t wanted_settle_s = 0;
  std::int32_t wanted_ramp_w_max = 0;
};

/// 0: no ramp detected.
inline std::int32_t ramp_w_per_s(const StepResponseResult& speed) {
  const double ramp_s_per_w = speed.dynamics.ramp_s_per_w;
  return ramp_s_per_w > 0 ? static_cast<std::int32_t>(1 / ramp_s_per_w) : 0;
}

/// `large`: null if only the small step was possible.
StepResponseResult judge_speed(const StepResponse& small, const StepResponse* large,
                               const StepResponseCriteria& criteria);

struct CommissionSettings {
  std::int32_t power_w = 500;
  std::int32_t rest_s = 10;    ///< time to reach 0 W
  std::int32_t drive_s = 30;   ///< time to follow
  std::int32_t unfed_s = 0;    ///< an order must last this long without a refresh; 0 = drive_s
  std::int32_t noise_w = 150;  ///< power and meter error at rest
  /// By which the measured power may fall short of the order.
  std::int32_t tolerance_percent = 50;
  ResponseBand response{};          ///< from the map
  std::int32_t rated_w = 4'000;     ///< largest order of the controller
  std::int32_t step_w_max = 8'000;  ///< largest step between two orders
  /// Limits of the connection, house included, for the larger steps.
  std::int32_t import_w_max = kAnyPowerW;
  std::int32_t export_w_max = kAnyPowerW;
  bool drives_further = true;
  std::int32_t soc_min_e4 = 1'000;
  std::int32_t soc_max_e4 = 10'000;
  std::int32_t order_duration_s = 300;  ///< until the device's watchdog ends it
};

enum class CommissionVerdict : std::uint8_t {
  kPassed,
  kNoLink,         ///< a read, an order or the release failed; see `status`
  kAlarm,          ///< alarm or off-grid: no test
  kForeignOrder,   ///< the battery follows an order already
  kNoRoom,         ///< neither direction can be tested
  kNotAtRest,      ///< power flows although 0 W is ordered
  kDoesNotFollow,  ///< almost no power flows
  kWrongSign,      ///< power flows in the opposite direction
  kTooMuch,        ///< more than ordered
  kEndsEarly,      ///< the power came, and stopped before the next refresh was due
  kTooLittle,      ///< less than the map's [response] allows
  kSlow,           ///< slower than the map's [response] says
  kMeterLost,      ///< see `status`
  kMeterMismatch,  ///< the meter does not step with the battery
  kMeterRestless,  ///< the house load varies too much
  kInterrupted
};

/// Meaning and remedy. In brackets: one text on two lines.
constexpr std::string_view commission_text(CommissionVerdict verdict) {
  constexpr std::string_view kTexts[] = {
      "passed",
      "the battery did not answer or refused",
      "the battery reports an alarm or is off-grid: clear it first",
      "the battery follows an order already: stop the other controller, or wait for its timer",
      "neither direction can be tested: soc_min, soc_max or the battery's limits leave no range",
      "power flows although 0 W is ordered",
      "hardly any power flows",
      "power flows the wrong way: the sign of battery_power or of the order is wrong in the map",
      ("more power flows than ordered: unit or scale of the order or of battery_power is wrong in "
       "the map, or another controller drives the battery"),
      ("the power came and went while the order was in force: the device ends orders earlier than "
       "[watchdog] of the map says; set"),
      ("less power flows than [response] of the map allows: check its scale. If this is normal for "
       "the battery, set"),
      "the battery follows more slowly than [response] of the map says; set",
      "the meter cannot be read",
      ("the meter does not step with the battery: frozen, inverted, of another phase or ratio, or "
       "not at the connection"),
      "the house moved too much to check the meter: repeat when the house is quiet",
      "interrupted; the battery was released"};
  static_assert(std::size(kTexts) == static_cast<int>(CommissionVerdict::kInterrupted) + 1);
  return kTexts[static_cast<int>(verdict)];
}

/// Result of one direction.
struct DirectionResult {
  bool is_tested = false;
  std::int32_t ordered_power_w = 0;
  std::int32_t measured_power_w = 0;  ///< settled
  std::int64_t came_ms = 0;           ///< until it matched the order
  std::int32_t further_w = 0;         ///< the larger order; 0: not possible
  std::int32_t further_measured_w = 0;
  bool is_held_back = false;  ///< less than that flows permanently
  StepResponseResult speed{};
};

struct CommissionResult {
  CommissionVerdict verdict = CommissionVerdict::kNoLink;
  Status status = Status::kOk;
  Status release_status = Status::kOk;  ///< else the battery may still follow the order
  std::int32_t soc_e4 = 0;
  std::int16_t lost_point = 0;        ///< of the failed reading: 1 + index; 0 = none
  std::int32_t ordered_power_w = 0;   ///< last
  std::int32_t measured_power_w = 0;  ///< with that order in force
  DirectionResult charge{};
  DirectionResult discharge{};
  MeterVerdict meter = MeterVerdict::kNotAsked;
  std::int32_t meter_percent = 0;  ///< share of the battery's steps shown by the meter
  std::int32_t rest_house_w = 0;   ///< grid minus battery, at rest
  /// Optional points of this device.
  StaticVector<std::int8_t, kPointsMax> present{};
  /// Settings for map and configuration with which it would pass; 0: no change.
  std::int32_t wanted_duration_s = 0;  ///< of [watchdog]
  std::int32_t wanted_settle_s = 0;
  std::int32_t wanted_tolerance_w = 0;
  std::int32_t wanted_ramp_w_max = 0;  ///< of [guard]: what it reaches within settle_s
};

}  // namespace bess
