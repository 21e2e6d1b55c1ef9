// The sign check that a new battery must pass before it may be controlled: a small order, and a
// look at which way the power goes. A map's sign is documented both ways for some devices, and
// registers that read back as written prove nothing about it.
//
//   read -> rest: 0 W ordered, power must be near 0 -> drive: a small order, power must follow ->
//   release
//
// A template over battery and clock like the control loop (control_loop.h names what they offer).
#pragma once

#include <cstdint>
#include <string_view>

#include "edge/control/control_types.h"
#include "edge/registers/codec.h"
#include "shared/scaled_clock.h"

namespace bess {

struct CommissionSettings {
  std::int32_t power_w = 500;
  std::int32_t rest_s = 10;             ///< for the battery to come to 0 W
  std::int32_t drive_s = 30;            ///< for the battery to follow
  std::int32_t noise_w = 150;           ///< a resting battery and its meter may show this much
  std::int32_t tolerance_percent = 50;  ///< by which the power that flows may miss the order
  std::int32_t soc_min_e4 = 1'000;
  std::int32_t soc_max_e4 = 10'000;
  std::int32_t order_duration_s = 300;  ///< until the device's watchdog ends it
};

enum class CommissionVerdict : std::uint8_t {
  kPassed,
  kNoLink,         ///< a read, an order or the release failed; `status` says why
  kAlarm,          ///< alarm or off-grid: no time for an experiment
  kForeignOrder,   ///< the battery follows an order already
  kNotAtRest,      ///< power flows although 0 W is ordered
  kDoesNotFollow,  ///< hardly any power flows
  kWrongSign,      ///< power flows the other way
  kInterrupted
};

/// What it means and what mends it.
constexpr std::string_view commission_text(CommissionVerdict verdict) {
  constexpr std::string_view kTexts[] = {
      "passed",
      "the battery did not answer or refused",
      "the battery reports an alarm or is off-grid: clear that first",
      "the battery follows an order already: stop the other controller, or wait for its timer",
      "power flows although 0 W is ordered: is the map right, does another controller interfere?",
      "hardly any power flows: is external control enabled on the device, is the battery ready?",
      "power flows the wrong way: the sign of battery_power or of the order is wrong in the map",
      "interrupted; the battery was released"};
  return kTexts[static_cast<int>(verdict)];
}

struct CommissionResult {
  CommissionVerdict verdict = CommissionVerdict::kNoLink;
  Status status = Status::kOk;
  Status release_status = Status::kOk;  ///< else the battery may still follow the order
  std::int32_t ordered_power_w = 0;
  std::int32_t measured_power_w = 0;  ///< with that order in force
};

template <typename Battery, typename Clock>
class SignCheck {
 public:
  SignCheck(const CommissionSettings& settings, Battery& battery, Clock& clock)
      : settings_(settings), battery_(battery), clock_(clock) {}

  CommissionResult run() {
    CommissionResult result;
    BatteryMeasurement before;
    if (!succeeded(battery_.read(before), result)) return result;
    if (before.alarm || before.off_grid) return fail(result, CommissionVerdict::kAlarm);
    if (before.dispatch_active) return fail(result, CommissionVerdict::kForeignOrder);
    const bool has_room = before.soc_e4 < (settings_.soc_min_e4 + settings_.soc_max_e4) / 2;
    result.ordered_power_w = has_room ? settings_.power_w : -settings_.power_w;
    const bool rests = order_and_watch(0, settings_.rest_s, result);
    if (rests) check_rest(result);
    if (rests && result.verdict == CommissionVerdict::kPassed) {
      if (order_and_watch(result.ordered_power_w, settings_.drive_s, result)) check_drive(result);
    }
    release(result);
    return result;
  }

 private:
  static CommissionResult fail(CommissionResult& result, CommissionVerdict verdict) {
    result.verdict = verdict;
    return result;
  }

  static bool succeeded(Status status, CommissionResult& result) {
    if (status == Status::kOk) return true;
    result.verdict = CommissionVerdict::kNoLink;
    result.status = status;
    return false;
  }

  /// Orders, waits while feeding the watchdog, measures; false when that was not possible.
  bool order_and_watch(std::int32_t power_w, std::int32_t seconds, CommissionResult& result) {
    const PowerOrder order{.power_w = power_w,
                           .soc_min_e4 = settings_.soc_min_e4,
                           .soc_max_e4 = settings_.soc_max_e4,
                           .duration_s = settings_.order_duration_s};
    if (!succeeded(battery_.order(order), result)) return false;
    if (!wait(seconds)) {
      result.verdict = CommissionVerdict::kInterrupted;
      return false;
    }
    BatteryMeasurement measurement;
    if (!succeeded(battery_.read(measurement), result)) return false;
    result.measured_power_w = measurement.power_w;
    return true;
  }

  bool wait(std::int32_t seconds) {
    const std::int32_t interval_s = battery_.refresh_interval_s();
    std::int64_t now_ns = clock_.now_utc_ns();
    const std::int64_t end_ns = now_ns + seconds * kNanosecondsPerSecond;
    while (interval_s > 0 && now_ns + interval_s * kNanosecondsPerSecond < end_ns) {
      now_ns += interval_s * kNanosecondsPerSecond;
      if (!clock_.sleep_until_utc_ns(now_ns)) return false;
      static_cast<void>(battery_.refresh());  // what fails here shows in the measurement
    }
    return clock_.sleep_until_utc_ns(end_ns);
  }

  void check_rest(CommissionResult& result) const {
    const std::int32_t power_w = result.measured_power_w;
    const bool rests = power_w <= settings_.noise_w && power_w >= -settings_.noise_w;
    result.verdict = rests ? CommissionVerdict::kPassed : CommissionVerdict::kNotAtRest;
  }

  void check_drive(CommissionResult& result) const {
    const bool same_sign = (result.measured_power_w > 0) == (result.ordered_power_w > 0);
    const std::int32_t magnitude_w =
        result.measured_power_w < 0 ? -result.measured_power_w : result.measured_power_w;
    if (magnitude_w < settings_.power_w * (100 - settings_.tolerance_percent) / 100) {
      result.verdict = CommissionVerdict::kDoesNotFollow;
    } else {
      result.verdict = same_sign ? CommissionVerdict::kPassed : CommissionVerdict::kWrongSign;
    }
  }

  /// On every way out, and tried until the link has had its chance to come back; a verdict that failed earlier says more than the release's.
  void release(CommissionResult& result) {
    const std::int64_t last_ns = clock_.now_utc_ns() + kReleasePatienceNs;
    result.release_status = battery_.release();
    while (result.release_status != Status::kOk && clock_.now_utc_ns() < last_ns) {
      clock_.pause_ns(5 * kNanosecondsPerSecond);
      result.release_status = battery_.release();
    }
    if (result.verdict != CommissionVerdict::kPassed) return;
    static_cast<void>(succeeded(result.release_status, result));
  }

  /// Longer than the link pauses between two connects.
  static constexpr std::int64_t kReleasePatienceNs = 65 * kNanosecondsPerSecond;

  CommissionSettings settings_;
  Battery& battery_;
  Clock& clock_;
};

}  // namespace bess
