// Input and findings of a sign check (commission.h), with the speed of the answer to its orders.
#pragma once

#include <cstdint>
#include <string_view>

#include "edge/core/base/response_band.h"
#include "edge/core/control/site_types.h"
#include "edge/device/battery/meter_proof.h"
#include "edge/device/battery/step_fit.h"
#include "edge/device/registers/codec.h"

namespace bess {

// Is a battery as quick as its map says, for the largest step that the controller may order? Judged
// by a small step and, where SoC and limits left room, a larger one of the same direction.
//
//   both     refused only if the fit over both leaves nothing quicker possible, or the largest step
//            itself was seen to be late
//   one      refused only if it was late itself: the time of a larger one is reported as a range

struct SpeedQuestion {
  ResponseBand response{};       ///< what the map says
  std::int32_t rated_w = 4'000;  ///< the most that is ordered
  std::int32_t step_w_max = 8'000;

  /// What the answer to such a step, half of it each way, may miss.
  [[nodiscard]] std::int32_t band_w(std::int32_t step_w) const {
    return response.tolerance_of_w(rated_w, step_w / 2);
  }
};

struct AnswerSpeed {
  bool has_two = false;      ///< steps of different size
  bool is_slow = false;      ///< slower than [response] says, surely
  bool is_doubtful = false;  ///< it may be
  StepDynamics dynamics{};   ///< without a ramp where none was seen for certain
  SecondsOfStep largest{};   ///< that the largest step takes
  /// Lines with which it would pass; 0: leave it.
  std::int32_t wanted_settle_s = 0;
  std::int32_t wanted_ramp_w_max = 0;
};

/// 0: no ramp was seen.
inline std::int32_t ramp_w_per_s(const AnswerSpeed& speed) {
  const double ramp_s_per_w = speed.dynamics.ramp_s_per_w;
  return ramp_s_per_w > 0 ? static_cast<std::int32_t>(1 / ramp_s_per_w) : 0;
}

/// `large`: null where only the small step was possible.
AnswerSpeed judge_speed(const AnswerCurve& small, const AnswerCurve* large,
                        const SpeedQuestion& question);

struct CommissionSettings {
  std::int32_t power_w = 500;
  std::int32_t rest_s = 10;    ///< for the battery to come to 0 W
  std::int32_t drive_s = 30;   ///< for the battery to follow
  std::int32_t unfed_s = 0;    ///< an order must last so long without being fed; 0 = drive_s
  std::int32_t noise_w = 150;  ///< a resting battery and its meter may show this much
  std::int32_t tolerance_percent =
      50;                           ///< by which the power that flows may fall short of the order
  ResponseBand response{};          ///< what the map says of its battery
  std::int32_t rated_w = 4'000;     ///< the most that the controller orders
  std::int32_t step_w_max = 8'000;  ///< between two of its orders
  /// Of the connection, house included, for the larger steps.
  std::int32_t import_w_max = kAnyPowerW;
  std::int32_t export_w_max = kAnyPowerW;
  bool drives_further = true;
  std::int32_t soc_min_e4 = 1'000;
  std::int32_t soc_max_e4 = 10'000;
  std::int32_t order_duration_s = 300;  ///< until the device's watchdog ends it
};

enum class CommissionVerdict : std::uint8_t {
  kPassed,
  kNoLink,         ///< a read, an order or the release failed; `status` says why
  kAlarm,          ///< alarm or off-grid: no time for an experiment
  kForeignOrder,   ///< the battery follows an order already
  kNoRoom,         ///< neither direction can be tested
  kNotAtRest,      ///< power flows although 0 W is ordered
  kDoesNotFollow,  ///< hardly any power flows
  kWrongSign,      ///< power flows the other way
  kTooMuch,        ///< more than ordered
  kEndsEarly,      ///< the power came, and went before the order was due to be fed
  kTooLittle,      ///< less than the map's [response] allows
  kSlow,           ///< slower than the map's [response] says
  kMeterLost,      ///< `status` says why
  kMeterMismatch,  ///< the meter does not step with the battery
  kMeterRestless,  ///< the house moves too much to tell
  kInterrupted
};

/// What it means and what mends it. In brackets where two lines are one text.
constexpr std::string_view commission_text(CommissionVerdict verdict) {
  constexpr std::string_view kTexts[] = {
      "passed",
      "the battery did not answer or refused",
      "the battery reports an alarm or is off-grid: clear that first",
      "the battery follows an order already: stop the other controller, or wait for its timer",
      ("neither direction can be tested: between soc_min and soc_max, or by the battery's own "
       "limits, there is no room"),
      "power flows although 0 W is ordered",
      "hardly any power flows",
      "power flows the wrong way: the sign of battery_power or of the order is wrong in the map",
      ("more power flows than ordered: unit or scale of the order or of battery_power is wrong in "
       "the map, or something else drives the battery"),
      ("the power came and went while the order was in force: the device ends orders earlier than "
       "[watchdog] of the map says; set"),
      ("less power flows than [response] of the map allows: is its scale right? If this is how the "
       "battery is, set"),
      "the battery follows more slowly than [response] of the map says; set",
      "the meter cannot be read",
      ("the meter does not step with the battery: frozen, inverted, of another phase or ratio, or "
       "not at the connection"),
      ("the house moved too much to tell whether the meter follows: repeat it when the house is "
       "quiet"),
      "interrupted; the battery was released"};
  static_assert(std::size(kTexts) == static_cast<int>(CommissionVerdict::kInterrupted) + 1);
  return kTexts[static_cast<int>(verdict)];
}

/// What one way of driving it showed.
struct DirectionResult {
  bool is_tested = false;
  std::int32_t ordered_power_w = 0;
  std::int32_t measured_power_w = 0;  ///< settled
  std::int64_t came_ms = 0;           ///< until it was what was ordered
  std::int32_t further_w = 0;         ///< ordered then; 0: no larger step was possible
  std::int32_t further_measured_w = 0;
  bool is_held_back = false;  ///< of that, less flows than was ordered
  AnswerSpeed speed{};
};

struct CommissionResult {
  CommissionVerdict verdict = CommissionVerdict::kNoLink;
  Status status = Status::kOk;
  Status release_status = Status::kOk;  ///< else the battery may still follow the order
  std::int32_t soc_e4 = 0;
  std::int16_t lost_point = 0;        ///< of the reading that failed: 1 + index; 0 = none
  std::int32_t ordered_power_w = 0;   ///< last
  std::int32_t measured_power_w = 0;  ///< with that order in force
  DirectionResult charge{};
  DirectionResult discharge{};
  MeterVerdict meter = MeterVerdict::kNotAsked;
  std::int32_t meter_percent = 0;  ///< of the battery's steps that the meter showed
  std::int32_t rest_house_w = 0;   ///< grid less battery, at rest
  /// Optional points that this device has.
  StaticVector<std::int8_t, kPointsMax> present{};
  /// Lines for the map and the configuration with which it would pass; 0: leave it.
  std::int32_t wanted_duration_s = 0;  ///< of [watchdog]
  std::int32_t wanted_settle_s = 0;
  std::int32_t wanted_tolerance_w = 0;
  std::int32_t wanted_ramp_w_max = 0;  ///< of [guard]: what it manages within settle_s
};

}  // namespace bess
