// Sign check of a new battery before it may be controlled: small orders, and the direction, size
// and time of the resulting power, and whether the meter at the connection shows it. For some
// devices a map's sign is documented both ways, and a register read-back proves nothing about it.
//
//   read -> rest: 0 W, power must be near 0 -> drive one way -> rest -> drive the other way -> rest
//        -> if SoC and limits permit: half the largest step one way -> from there the other way,
//           which is the largest -> and back -> rest                                   -> release
//
// The small steps verify the direction before any larger order; the larger ones, a few seconds
// long, separate a lag from a ramp (commission_types.h). A direction that the SoC or the battery's
// own limit excludes is not tested, and reported. Power beyond the order ends the test immediately.
// A template over battery, clock and meter (first two: control_loop.h).
//
//   Meter   bool exists();  Status read(const BatteryMeasurement&, int32& grid_power_w)
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "edge/core/control/control_types.h"
#include "edge/core/control/power_order.h"
#include "edge/device/battery/commission_types.h"
#include "edge/device/battery/step_fit.h"
#include "shared/scaled_clock.h"

namespace bess {

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
    if (!reads(before_)) return result_;
    result_.soc_e4 = before_.soc_e4;
    if (before_.alarm || before_.off_grid) return fail(CommissionVerdict::kAlarm);
    if (before_.dispatch_active) return fail(CommissionVerdict::kForeignOrder);
    const auto can_drive = [this](int sign) {
      return room_e4(sign) >= kRoomE4 && limit_w(sign) >= settings_.power_w;
    };
    if (!can_drive(1) && !can_drive(-1)) return fail(CommissionVerdict::kNoRoom);
    const int first = before_.soc_e4 < (settings_.soc_min_e4 + settings_.soc_max_e4) / 2 ? 1 : -1;
    result_.verdict = CommissionVerdict::kPassed;
    if (rests() && can_drive(first)) drives(first);
    if (passes() && can_drive(-first)) drives(-first);
    judge_meter();
    if (passes() && settings_.drives_further) drives_further(first);
    release();
    judge_speeds();
    return result_;
  }

 private:
  static constexpr std::int32_t kRoomE4 = 100;
  static constexpr std::int64_t kReadingEveryNs = kNanosecondsPerSecond;
  /// Readings with too much power until release.
  static constexpr int kReadingsBeyond = 2;
  /// For a larger step: up to a minute of the rating, and away from the ends where a battery
  /// limits.
  static constexpr std::int32_t kFurtherRoomE4 = 500;
  static constexpr std::int32_t kFurtherS = 8;
  /// Settled power must stay for this time, and a third of its rise time.
  static constexpr std::int64_t kStaysMs = 5'000;
  /// A slow battery also needs time to come to rest.
  static constexpr std::int32_t kRestPatienceS = 240;
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

  bool reads(BatteryMeasurement& m) {
    const Status status = battery_.read(m);
    result_.lost_point = m.lost_point;
    if (status == Status::kOk && m.lost_point != 0) return succeeded(Status::kImplausible);
    return succeeded(status);
  }

  struct MeasuredSteps {
    std::optional<StepResponse> small;
    std::optional<StepResponse> large;
  };
  DirectionResult& direction(int sign) { return sign > 0 ? result_.charge : result_.discharge; }
  MeasuredSteps& seen(int sign) { return sign > 0 ? seen_charge_ : seen_discharge_; }
  [[nodiscard]] std::int32_t limit_w(int sign) const {
    return sign > 0 ? before_.charge_w_max : before_.discharge_w_max;
  }
  [[nodiscard]] std::int32_t room_e4(int sign) const {
    return sign > 0 ? settings_.soc_max_e4 - before_.soc_e4 : before_.soc_e4 - settings_.soc_min_e4;
  }

  bool rests(std::int32_t patience_s = 0) {
    StepResponse ignored(1, 0);
    // A meter may lag the battery by one to ten seconds.
    const std::int32_t meter_s = reads_meter() ? settings_.response.settle_s + 5 : 0;
    const std::int32_t rest_s = std::max(settings_.rest_s, meter_s);
    if (!order_and_watch(0, rest_s, std::max(settings_.drive_s, patience_s), ignored)) return false;
    if (!is_at_rest()) fail(CommissionVerdict::kNotAtRest);
    if (reads_meter()) result_.rest_house_w = last_grid_w_ - result_.measured_power_w;
    return passes();
  }
  [[nodiscard]] bool is_at_rest() const {
    return result_.measured_power_w <= settings_.noise_w &&
           result_.measured_power_w >= -settings_.noise_w;
  }

  [[nodiscard]] bool reads_meter() const { return meter_.exists() && !is_further_; }

  /// Drives in one direction and back to rest.
  void drives(int sign) {
    StepResponse& curve = seen(sign).small.emplace(settings_.power_w, band_w(settings_.power_w),
                                                   sign * last_power_w_);
    const bool is_watched =
        order_and_watch(sign * settings_.power_w, drive_s(sign), settings_.drive_s, curve);
    direction(sign) = {.is_tested = true,
                       .ordered_power_w = sign * settings_.power_w,
                       .measured_power_w = result_.measured_power_w,
                       .came_ms = curve.came_ms()};
    if (is_watched) judge_drive(sign * result_.measured_power_w, curve);
    if (passes()) rest_and_report(direction(sign));
  }
  /// The first test lasts as long as an order must last without a refresh.
  std::int32_t drive_s(int sign) {
    const bool is_long = !was_unfed_ && room_e4(sign) >= kFurtherRoomE4;
    was_unfed_ = was_unfed_ || is_long;
    return is_long ? std::max(settings_.drive_s, settings_.unfed_s) : settings_.drive_s;
  }
  void rest_and_report(const DirectionResult& driven) {
    rests(kRestPatienceS);
    result_.ordered_power_w = driven.ordered_power_w;
    if (passes()) result_.measured_power_w = driven.measured_power_w;
  }

  /// From rest half the largest step, then the largest to the other side and back; if only one
  /// direction is possible, its largest.
  void drives_further(int first) {
    is_further_ = true;
    const std::int32_t to_w = further_w(first);
    const std::int32_t back_w = further_w(-first);
    const std::int32_t both_w = std::min({to_w, back_w, settings_.step_w_max / 2});
    const std::int32_t one_w = std::min(std::max(to_w, back_w), settings_.step_w_max);
    const int one = to_w > 0 ? first : -first;
    if (both_w >= settings_.power_w) {
      for (const int sign : {first, -first, first}) {
        if (!drives_on(sign, both_w) || !passes()) break;
      }
    } else if (std::min(to_w, back_w) == 0 && one_w >= 2 * settings_.power_w) {
      drives_on(one, one_w);
    } else {
      return;
    }
    if (passes()) rest_and_report(direction(direction(-first).is_tested ? -first : first));
  }
  /// 0: not tested.
  [[nodiscard]] std::int32_t further_w(int sign) {
    if (!direction(sign).is_tested || room_e4(sign) < kFurtherRoomE4) return 0;
    const std::int64_t house_w = result_.rest_house_w;
    const std::int64_t grid_w =
        sign > 0 ? settings_.import_w_max - house_w : settings_.export_w_max + house_w;
    const std::int64_t most_w =
        std::min({grid_w, std::int64_t{settings_.rated_w}, std::int64_t{limit_w(sign)}});
    return static_cast<std::int32_t>(std::max<std::int64_t>(most_w, 0));
  }
  /// True if the power settled.
  bool drives_on(int sign, std::int32_t power_w) {
    StepResponse curve(power_w, band_w(power_w), sign * last_power_w_);
    const std::int32_t last_s = std::max(2 * settings_.drive_s, settings_.response.settle_s + 10);
    if (!order_and_watch(sign * power_w, kFurtherS, last_s - kFurtherS, curve)) return false;
    DirectionResult& driven = direction(sign);
    driven.further_w = sign * power_w;
    driven.further_measured_w = result_.measured_power_w;
    if (is_beyond(sign * power_w)) fail(CommissionVerdict::kTooMuch);
    driven.is_held_back = !curve.has_come() && !curve.is_rising();
    if (!driven.is_held_back) seen(sign).large = curve;
    return curve.has_come();
  }

  /// Orders, then reads and refreshes the watchdog until the time is over; false on failure.
  bool order_and_watch(std::int32_t power_w, std::int32_t seconds, std::int32_t patience_s,
                       StepResponse& curve) {
    const PowerOrder order{.power_w = power_w,
                           .soc_min_e4 = settings_.soc_min_e4,
                           .soc_max_e4 = settings_.soc_max_e4,
                           .duration_s = settings_.order_duration_s};
    proof_.end_plateau();
    result_.ordered_power_w = power_w;
    if (!succeeded(battery_.order(order))) return false;
    const std::int64_t start_ns = clock_.now_utc_ns();
    const std::int64_t end_ns = start_ns + seconds * kNanosecondsPerSecond;
    // A late response is watched longer, to measure the delay.
    const std::int64_t last_ns = end_ns + patience_s * kNanosecondsPerSecond;
    fed_ns_ = start_ns;
    has_flowed_ = false;
    gone_ns_ = 0;
    int beyond = 0;
    while (true) {
      const std::int64_t now_ns = clock_.now_utc_ns();
      const bool has_come = power_w == 0 ? is_at_rest() : has_stayed(curve, now_ns - start_ns);
      if (now_ns >= end_ns && (has_come || now_ns >= last_ns)) break;
      const std::int64_t next_ns = now_ns + kReadingEveryNs;
      if (!wait(now_ns < end_ns ? std::min(next_ns, end_ns) : next_ns)) return false;
      if (!look(power_w, start_ns, end_ns, curve)) return false;
      beyond = is_beyond(power_w) ? beyond + 1 : 0;
      if (beyond >= kReadingsBeyond) break;
    }
    return true;
  }

  static bool has_stayed(const StepResponse& curve, std::int64_t since_ns) {
    const std::int64_t stays_ms = std::max(kStaysMs, curve.came_ms() / 3);
    return curve.has_come() && since_ns / 1'000'000 - curve.came_ms() >= stays_ms;
  }

  /// One reading of battery and meter.
  bool look(std::int32_t power_w, std::int64_t start_ns, std::int64_t end_ns, StepResponse& curve) {
    BatteryMeasurement m;
    const std::int64_t begin_ns = clock_.now_utc_ns();
    if (!reads(m)) return false;
    const std::int64_t now_ns = clock_.now_utc_ns();
    result_.measured_power_w = last_power_w_ = m.power_w;
    if (m.alarm || m.off_grid) fail(CommissionVerdict::kAlarm);
    note_end(power_w, now_ns);
    // After settling, the rest of a long order has no information on the response time.
    const std::int64_t ordered_until_ns = start_ns + settings_.drive_s * kNanosecondsPerSecond;
    if (!curve.has_come() || begin_ns <= ordered_until_ns) {
      curve.add({.begin_ms = (begin_ns - start_ns) / 1'000'000,
                 .end_ms = (now_ns - start_ns) / 1'000'000,
                 .along_w = power_w < 0 ? -std::max(m.power_w, -INT32_MAX) : m.power_w});
    }
    if (!passes() || !reads_meter()) return passes();
    if (!succeeded(meter_.read(m, last_grid_w_), CommissionVerdict::kMeterLost)) return false;
    // Only the last third: both meters have settled.
    if (begin_ns - start_ns >= (end_ns - start_ns) / 3 * 2) proof_.add(m.power_w, last_grid_w_);
    return true;
  }

  /// Two consecutive readings with almost no power, after most of it had come.
  void note_end(std::int32_t power_w, std::int64_t now_ns) {
    const std::int64_t along_w = std::int64_t{result_.measured_power_w} * (power_w < 0 ? -1 : 1);
    const std::int64_t ordered_w = std::abs(std::int64_t{power_w});
    if (2 * along_w >= ordered_w) has_flowed_ = true;
    const bool is_gone = power_w != 0 && has_flowed_ && 4 * along_w < ordered_w;
    if (!is_gone) gone_ns_ = 0;
    if (!is_gone || !passes()) return;
    if (gone_ns_ == 0) {
      gone_ns_ = now_ns;
      return;
    }
    result_.wanted_duration_s = static_cast<std::int32_t>(
        std::max<std::int64_t>((gone_ns_ - fed_ns_) / kNanosecondsPerSecond - 1, 2));
    fail(CommissionVerdict::kEndsEarly);
  }

  /// Refreshes while waiting; failures show in the measurement.
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

  /// Permitted error of a power, by the map; small steps get no tolerance from a high rating.
  [[nodiscard]] std::int32_t band_w(std::int32_t power_w) const {
    return settings_.response.tolerance_of_w(is_further_ ? settings_.rated_w : 0, power_w);
  }
  [[nodiscard]] bool is_beyond(std::int32_t power_w) const {
    if (power_w == 0) return false;  // it may still be decaying
    const std::int64_t ordered_w = power_w < 0 ? -power_w : power_w;
    const std::int64_t most_w = ordered_w + band_w(static_cast<std::int32_t>(ordered_w));
    return result_.measured_power_w > most_w || result_.measured_power_w < -most_w;
  }

  void judge_drive(std::int32_t along_w, const StepResponse& curve) {
    const std::int32_t least_w = settings_.power_w * (100 - settings_.tolerance_percent) / 100;
    if (along_w <= -std::max(least_w, 1)) {
      fail(CommissionVerdict::kWrongSign);
    } else if (along_w < least_w) {
      fail(CommissionVerdict::kDoesNotFollow);
    } else if (along_w > settings_.power_w + band_w(settings_.power_w)) {
      fail(CommissionVerdict::kTooMuch);
    } else if (along_w < settings_.power_w - band_w(settings_.power_w) && !curve.is_rising()) {
      result_.wanted_tolerance_w = rounded_up((settings_.power_w - along_w) * 5 / 4, 50);
      fail(CommissionVerdict::kTooLittle);
    }
  }

  /// A battery may be faster in one direction.
  void judge_speeds() {
    const StepResponseCriteria criteria{.response = settings_.response,
                                        .rated_w = settings_.rated_w,
                                        .step_w_max = settings_.step_w_max};
    if (!passes()) return;
    for (const int sign : {1, -1}) {
      const MeasuredSteps& of = seen(sign);
      if (!of.small.has_value()) continue;
      StepResponseResult& speed = direction(sign).speed;
      speed = judge_speed(*of.small, of.large.has_value() ? &*of.large : nullptr, criteria);
      if (speed.is_slow) take_proposal(speed);
    }
  }
  void take_proposal(const StepResponseResult& speed) {
    fail(CommissionVerdict::kSlow);
    result_.wanted_settle_s = std::max(result_.wanted_settle_s, speed.wanted_settle_s);
    const std::int32_t step_w = result_.wanted_ramp_w_max;
    if (speed.wanted_ramp_w_max == 0) return;
    result_.wanted_ramp_w_max =
        step_w == 0 ? speed.wanted_ramp_w_max : std::min(step_w, speed.wanted_ramp_w_max);
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

  /// Called on every exit, and retried until the link could reconnect; an earlier failure takes
  /// precedence over the release's.
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
  BatteryMeasurement before_;
  MeasuredSteps seen_charge_;
  MeasuredSteps seen_discharge_;
  bool is_further_ = false;
  bool was_unfed_ = false;
  MeterProof proof_;
  std::int32_t last_power_w_ = 0;
  std::int32_t last_grid_w_ = 0;
  bool has_flowed_ = false;   ///< since the newest order
  std::int64_t gone_ns_ = 0;  ///< first reading without its power; 0 = none
  std::int64_t fed_ns_ = 0;   ///< last order or refresh
};

}  // namespace bess
