// The sign check that a new battery must pass before it may be controlled: small orders, and a
// look at which way the power goes, how much of it, how soon, and whether the meter at the
// connection sees it. A map's sign is documented both ways for some devices, and registers that
// read back as written prove nothing about it.
//
//   read -> rest: 0 W, power must be near 0 -> drive one way -> rest -> drive the other way -> rest -> release
//
// A direction that the SoC, or the battery's own limit, does not leave is not tested, and said.
// Power beyond the order ends it at once. A template over battery, clock and meter like the
// control loop (control_loop.h names what the first two offer).
//
//   Meter   bool exists();  Status read(const BatteryMeasurement&, int32& grid_power_w)
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "edge/base/response_band.h"
#include "edge/battery/answer_curve.h"
#include "edge/battery/meter_proof.h"
#include "edge/control/control_types.h"
#include "edge/control/power_order.h"
#include "edge/registers/codec.h"
#include "shared/scaled_clock.h"

namespace bess {

struct CommissionSettings {
  std::int32_t power_w = 500;
  std::int32_t rest_s = 10;    ///< for the battery to come to 0 W
  std::int32_t drive_s = 30;   ///< for the battery to follow
  std::int32_t noise_w = 150;  ///< a resting battery and its meter may show this much
  std::int32_t tolerance_percent =
      50;                   ///< by which the power that flows may fall short of the order
  ResponseBand response{};  ///< what the map says of its battery
  std::int32_t step_w_max =
      8'000;  ///< between two orders of the controller: what a ramp must manage
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
  kTooLittle,      ///< less than the map's [response] allows
  kSlow,           ///< slower than the map's [response] says
  kMeterLost,      ///< `status` says why
  kMeterMismatch,  ///< the meter does not step with the battery
  kMeterRestless,  ///< the house moves too much to tell
  kInterrupted
};

/// What it means and what mends it.
constexpr std::string_view commission_text(CommissionVerdict verdict) {
  constexpr std::string_view kTexts[] = {
      "passed",
      "the battery did not answer or refused",
      "the battery reports an alarm or is off-grid: clear that first",
      "the battery follows an order already: stop the other controller, or wait for its timer",
      "neither direction can be tested: SoC, soc_min and soc_max leave no room, or the battery's "
      "own limits",
      "power flows although 0 W is ordered: is the map right, does another controller interfere?",
      "hardly any power flows: is external control enabled on the device, is the battery ready?",
      "power flows the wrong way: the sign of battery_power or of the order is wrong in the map",
      "more power flows than ordered: unit or scale of the order or of battery_power is wrong in "
      "the map, or something "
      "else drives the battery",
      "less power flows than [response] of the map allows: is its scale right? If this is how the "
      "battery is, set",
      "the battery follows more slowly than [response] of the map says; set",
      "the meter cannot be read",
      "the meter does not step with the battery: frozen, inverted, of another phase or ratio, or "
      "not at the connection",
      "the house moved too much to tell whether the meter follows: repeat it when the house is "
      "quiet",
      "interrupted; the battery was released"};
  return kTexts[static_cast<int>(verdict)];
}

/// What one way of driving it showed.
struct DirectionResult {
  bool is_tested = false;
  std::int32_t ordered_power_w = 0;
  std::int32_t measured_power_w = 0;  ///< settled
  std::int64_t lag_ms = 0;            ///< until anything showed
  std::int64_t came_ms = 0;           ///< until it was what was ordered
  std::int32_t ramp_w_per_s = 0;      ///< 0: too fast to be seen
};

struct CommissionResult {
  CommissionVerdict verdict = CommissionVerdict::kNoLink;
  Status status = Status::kOk;
  Status release_status = Status::kOk;  ///< else the battery may still follow the order
  std::int32_t soc_e4 = 0;
  std::int32_t ordered_power_w = 0;   ///< last
  std::int32_t measured_power_w = 0;  ///< with that order in force
  DirectionResult charge{};
  DirectionResult discharge{};
  MeterVerdict meter = MeterVerdict::kNotAsked;
  std::int32_t meter_percent = 0;  ///< of the battery's steps that the meter showed
  std::int32_t rest_house_w = 0;   ///< grid less battery, at rest
  /// Lines for the map and the configuration with which it would pass; 0: leave it.
  std::int32_t wanted_settle_s = 0;
  std::int32_t wanted_tolerance_w = 0;
  std::int32_t wanted_ramp_w_max =
      0;  ///< of [guard]: the largest step that it manages within settle_s
};

struct NoCommissionMeter {
  [[nodiscard]] static bool exists() { return false; }
  static Status read(const BatteryMeasurement&, std::int32_t&) { return Status::kOk; }
};

template <typename Battery, typename Clock, typename Meter = NoCommissionMeter>
class SignCheck {
 public:
  SignCheck(const CommissionSettings& settings, Battery& battery, Clock& clock,
            Meter meter = Meter())
      : settings_(settings), battery_(battery), clock_(clock), meter_(meter) {}

  CommissionResult run() {
    BatteryMeasurement before;
    if (!succeeded(battery_.read(before))) return result_;
    result_.soc_e4 = before.soc_e4;
    if (before.alarm || before.off_grid) return fail(CommissionVerdict::kAlarm);
    if (before.dispatch_active) return fail(CommissionVerdict::kForeignOrder);
    const bool can_charge =
        before.soc_e4 <= settings_.soc_max_e4 - kRoomE4 && before.charge_w_max >= settings_.power_w;
    const bool can_discharge = before.soc_e4 >= settings_.soc_min_e4 + kRoomE4 &&
                               before.discharge_w_max >= settings_.power_w;
    if (!can_charge && !can_discharge) return fail(CommissionVerdict::kNoRoom);
    const bool has_room = before.soc_e4 < (settings_.soc_min_e4 + settings_.soc_max_e4) / 2;
    result_.verdict = CommissionVerdict::kPassed;
    if (rests() && (has_room ? can_charge : can_discharge)) drives(has_room ? 1 : -1);
    if (passes() && (has_room ? can_discharge : can_charge)) drives(has_room ? -1 : 1);
    judge_meter();
    release();
    return result_;
  }

 private:
  static constexpr std::int32_t kRoomE4 = 100;
  static constexpr std::int64_t kReadingEveryNs = kNanosecondsPerSecond;
  /// Of too much power, until it is given back.
  static constexpr int kReadingsBeyond = 2;
  static constexpr std::int32_t kSettleSMax = 100;  ///< that a map may say
  /// Longer than the link pauses between two connects.
  static constexpr std::int64_t kReleasePatienceNs = 65 * kNanosecondsPerSecond;

  CommissionResult fail(CommissionVerdict verdict) {
    result_.verdict = verdict;
    return result_;
  }
  [[nodiscard]] bool passes() const { return result_.verdict == CommissionVerdict::kPassed; }

  bool succeeded(Status status, CommissionVerdict verdict = CommissionVerdict::kNoLink) {
    if (status == Status::kOk) return true;
    result_.verdict = verdict;
    result_.status = status;
    return false;
  }

  bool rests() {
    AnswerCurve ignored(1, 0);
    // A meter may show a second later what the battery does, or ten.
    const std::int32_t meter_s = meter_.exists() ? settings_.response.settle_s + 5 : 0;
    if (!order_and_watch(0, std::max(settings_.rest_s, meter_s), ignored)) return false;
    if (!is_at_rest()) fail(CommissionVerdict::kNotAtRest);
    result_.rest_house_w = last_grid_w_ - result_.measured_power_w;
    return passes();
  }
  [[nodiscard]] bool is_at_rest() const {
    return result_.measured_power_w <= settings_.noise_w &&
           result_.measured_power_w >= -settings_.noise_w;
  }

  /// There and back again.
  void drives(int sign) {
    DirectionResult& direction = sign > 0 ? result_.charge : result_.discharge;
    AnswerCurve curve(settings_.power_w, band_w());
    const bool is_watched = order_and_watch(sign * settings_.power_w, settings_.drive_s, curve);
    direction = {.is_tested = true,
                 .ordered_power_w = sign * settings_.power_w,
                 .measured_power_w = result_.measured_power_w,
                 .lag_ms = curve.lag_ms(),
                 .came_ms = curve.came_ms(),
                 .ramp_w_per_s = curve.ramp_w_per_s()};
    if (is_watched) judge_drive(sign * result_.measured_power_w, curve);
    if (!passes()) return;
    const DirectionResult driven = direction;
    rests();
    result_.ordered_power_w = driven.ordered_power_w;
    if (passes()) result_.measured_power_w = driven.measured_power_w;
  }

  /// Orders, reads until the time is over, feeding the watchdog; false when that was not possible.
  bool order_and_watch(std::int32_t power_w, std::int32_t seconds, AnswerCurve& curve) {
    const PowerOrder order{.power_w = power_w,
                           .soc_min_e4 = settings_.soc_min_e4,
                           .soc_max_e4 = settings_.soc_max_e4,
                           .duration_s = settings_.order_duration_s};
    proof_.end_plateau();
    result_.ordered_power_w = power_w;
    if (!succeeded(battery_.order(order))) return false;
    const std::int64_t start_ns = clock_.now_utc_ns();
    const std::int64_t end_ns = start_ns + seconds * kNanosecondsPerSecond;
    // One that is late is watched for longer, to say by how much.
    const std::int64_t last_ns = end_ns + settings_.drive_s * kNanosecondsPerSecond;
    fed_ns_ = start_ns;
    int beyond = 0;
    while (true) {
      const std::int64_t now_ns = clock_.now_utc_ns();
      const bool has_come = power_w == 0 ? is_at_rest() : curve.has_come();
      if (now_ns >= end_ns && (has_come || now_ns >= last_ns)) break;
      const std::int64_t next_ns = now_ns + kReadingEveryNs;
      if (!wait(now_ns < end_ns ? std::min(next_ns, end_ns) : next_ns)) return false;
      if (!look(power_w, start_ns, end_ns, curve)) return false;
      beyond = is_beyond(power_w) ? beyond + 1 : 0;
      if (beyond >= kReadingsBeyond) break;
    }
    return true;
  }

  /// One reading of battery and meter.
  bool look(std::int32_t power_w, std::int64_t start_ns, std::int64_t end_ns, AnswerCurve& curve) {
    BatteryMeasurement m;
    const std::int64_t begin_ns = clock_.now_utc_ns();
    if (!succeeded(battery_.read(m))) return false;
    const std::int64_t now_ns = clock_.now_utc_ns();
    result_.measured_power_w = m.power_w;
    if (m.alarm || m.off_grid) fail(CommissionVerdict::kAlarm);
    curve.add({.begin_ms = (begin_ns - start_ns) / 1'000'000,
               .end_ms = (now_ns - start_ns) / 1'000'000,
               .along_w = power_w < 0 ? -std::max(m.power_w, -INT32_MAX) : m.power_w});
    if (!passes() || !meter_.exists()) return passes();
    if (!succeeded(meter_.read(m, last_grid_w_), CommissionVerdict::kMeterLost)) return false;
    // The last third: both meters have had time.
    if (begin_ns - start_ns >= (end_ns - start_ns) / 3 * 2) proof_.add(m.power_w, last_grid_w_);
    return true;
  }

  /// Refreshes on the way; what fails there shows in the measurement.
  bool wait(std::int64_t until_ns) {
    const std::int64_t interval_ns = battery_.refresh_interval_s() * kNanosecondsPerSecond;
    if (interval_ns > 0 && fed_ns_ + interval_ns <= until_ns) {
      if (!sleep(std::max(fed_ns_ + interval_ns, clock_.now_utc_ns()))) return false;
      static_cast<void>(battery_.refresh());
      fed_ns_ = clock_.now_utc_ns();
    }
    return sleep(until_ns);
  }
  bool sleep(std::int64_t until_ns) {
    if (clock_.sleep_until_utc_ns(until_ns)) return true;
    result_.verdict = CommissionVerdict::kInterrupted;
    return false;
  }

  /// What a power may miss, by the map.
  [[nodiscard]] std::int32_t band_w() const {
    return std::max(settings_.response.tolerance_w,
                    settings_.power_w * settings_.response.tolerance_percent / 100);
  }
  [[nodiscard]] bool is_beyond(std::int32_t power_w) const {
    if (power_w == 0) return false;  // it may still be on its way
    const std::int64_t most_w = std::int64_t{settings_.power_w} + band_w();
    return result_.measured_power_w > most_w || result_.measured_power_w < -most_w;
  }

  void judge_drive(std::int32_t along_w, const AnswerCurve& curve) {
    const std::int32_t least_w = settings_.power_w * (100 - settings_.tolerance_percent) / 100;
    if (along_w <= -std::max(least_w, 1)) {
      fail(CommissionVerdict::kWrongSign);
    } else if (along_w < least_w) {
      fail(CommissionVerdict::kDoesNotFollow);
    } else if (along_w > settings_.power_w + band_w()) {
      fail(CommissionVerdict::kTooMuch);
    } else if (along_w < settings_.power_w - band_w()) {
      result_.wanted_tolerance_w = rounded_up((settings_.power_w - along_w) * 5 / 4, 50);
      fail(CommissionVerdict::kTooLittle);
    } else {
      judge_speed(curve);
    }
  }

  /// Also the largest step that the controller may order, at the ramp that was seen.
  void judge_speed(const AnswerCurve& curve) {
    const std::int64_t ramp = curve.ramp_w_per_s();
    const std::int64_t lag_ms = curve.lag_ms();
    const std::int64_t step_ms = ramp > 0 ? settings_.step_w_max * std::int64_t{1'000} / ramp : 0;
    const std::int64_t needed_ms = std::max(curve.outside_until_ms(), lag_ms + step_ms);
    const std::int64_t settle_ms = std::int64_t{settings_.response.settle_s} * 1'000;
    if (needed_ms <= settle_ms) return;
    const std::int64_t wanted_s = (needed_ms + needed_ms / 5) / 1'000 + 1;
    result_.wanted_settle_s =
        static_cast<std::int32_t>(std::min<std::int64_t>(wanted_s, kSettleSMax));
    if (wanted_s > kSettleSMax && ramp > 0) {
      const std::int64_t left_ms = std::max<std::int64_t>(kSettleSMax * 1'000 - lag_ms, 1'000);
      result_.wanted_ramp_w_max = static_cast<std::int32_t>(ramp * left_ms / 1'000 * 4 / 5);
    }
    fail(CommissionVerdict::kSlow);
  }

  static std::int32_t rounded_up(std::int32_t value, std::int32_t to) {
    return (value + to - 1) / to * to;
  }

  void judge_meter() {
    proof_.end_plateau();
    result_.meter = proof_.verdict();
    result_.meter_percent = proof_.percent();
    if (!passes()) return;
    if (result_.meter == MeterVerdict::kMismatch) fail(CommissionVerdict::kMeterMismatch);
    if (result_.meter == MeterVerdict::kRestless) fail(CommissionVerdict::kMeterRestless);
  }

  /// On every way out, and tried until the link has had its chance to come back; a verdict that
  /// failed earlier says more than the release's.
  void release() {
    const std::int64_t last_ns = clock_.now_utc_ns() + kReleasePatienceNs;
    result_.release_status = battery_.release();
    while (result_.release_status != Status::kOk && clock_.now_utc_ns() < last_ns) {
      clock_.pause_ns(5 * kNanosecondsPerSecond);
      result_.release_status = battery_.release();
    }
    if (passes()) static_cast<void>(succeeded(result_.release_status));
  }

  CommissionSettings settings_;
  Battery& battery_;
  Clock& clock_;
  Meter meter_;
  CommissionResult result_;
  MeterProof proof_;
  std::int32_t last_grid_w_ = 0;
  std::int64_t fed_ns_ = 0;  ///< when the battery last got an order or a refresh
};

}  // namespace bess
