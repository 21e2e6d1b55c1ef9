// Site limits for the control loop: newest meter reading, energy of the quarter-hour and outside
// limits give the range of an order. A template over both sources, so that tests can replace them;
// either may be absent. No allocation.
//
//   Meter          Status read(int32& grid_power_w)       must end by its own deadline
//   OutsideLimits  Status read(OutsideLimit&, bool& is_set)
//
// Between two ticks the loop checks every `check_every_s` and cuts an order that has become too
// large. It never restores power before the next tick, so that readings and orders cannot
// oscillate. A tick's order keeps `margin_w` free; one in force is cut when half of that is used,
// so that a refrigerator causes no write. A meter that does not step with the battery is treated as
// lost (meter_check.h).
#pragma once

#include <algorithm>
#include <cstdint>

#include "edge/core/control/control_types.h"
#include "edge/core/control/site_types.h"
#include "edge/core/site/connection_guard.h"
#include "edge/core/site/meter_check.h"

namespace bess {

enum class MeterSource : std::uint8_t {
  kNone,
  kMap,     ///< a device of its own
  kBattery  ///< the battery's own grid point
};

/// Share of the margin that an order must keep free.
enum class Margin : std::uint8_t { kWhole, kHalf };

inline constexpr std::int32_t kMeterAgeMax_s = 30;  ///< maximum age of a reading
/// Interval of site readings between two ticks; at most half of the above: one may be lost.
inline constexpr std::int32_t kSiteCheck_s = 10;

struct SiteSettings {
  MeterSource meter = MeterSource::kNone;
  bool idle_without_meter = true;  ///< false: a lost meter sets no limit
  ConnectionSettings connection;
  MeterCheckSettings meter_check;
  std::int32_t pv_w_max = 0;  ///< PV behind the meter; kAnyPowerW: unknown
  bool has_outside_limits = false;
  bool idle_after_timeout = false;  ///< false: a lapsed or missing limit sets no limit
};

/// No site: nothing measured, no limits.
struct NoSite {
  void take_over(std::int64_t, const SiteReport&) {}
  [[nodiscard]] std::int32_t check_every_s() const { return 0; }
  [[nodiscard]] bool needs_battery() const { return false; }
  void observe(std::int64_t, bool, const BatteryMeasurement&, const ObservedOrder&) {}
  [[nodiscard]] SiteRange range(std::int64_t, Margin) const { return {}; }
  [[nodiscard]] SiteReport report(std::int64_t) const { return {}; }
};

template <typename Meter, typename OutsideLimits>
class SiteLimits {
 public:
  /// Null: absent. Both must outlive this object.
  SiteLimits(const SiteSettings& settings, Meter* meter, OutsideLimits* outside)
      : settings_(settings),
        meter_(meter),
        outside_(outside),
        meter_check_(settings.meter_check),
        energy_(settings.connection.peak_w_max == kAnyPowerW ? 0 : settings.connection.peak_w_max,
                kMeterAgeMax_s) {}

  /// State of an earlier run, from its last record.
  void take_over(std::int64_t utc_s, const SiteReport& before) {
    energy_.restore(utc_s, before.quarter_hour_import_wh, before.quarter_hour_battery_wh);
    meter_check_.restore(before.trust);
  }

  /// 0: nothing to check between two ticks.
  [[nodiscard]] std::int32_t check_every_s() const {
    return has_meter() || settings_.has_outside_limits ? kSiteCheck_s : 0;
  }
  /// The house load requires the battery's power of the same time.
  [[nodiscard]] bool needs_battery() const { return has_meter(); }

  /// Reads meter and outside limits. `battery` was read just before; `is_read`: successfully;
  /// `order`: the order that it followed.
  void observe(std::int64_t utc_s, bool is_read, const BatteryMeasurement& battery,
               const ObservedOrder& order) {
    read_outside_limits();
    if (!has_meter()) return;
    std::int32_t grid_w = 0;
    meter_status_ = read_meter(is_read, battery, grid_w);
    if (meter_status_ != Status::kOk || !is_read) return;
    read_utc_s_ = utc_s;
    grid_w_ = grid_w;
    battery_w_ = battery.power_w;
    energy_.add(utc_s, grid_w_, battery_w_);
    house_watch_.observe(is_plausible_house(grid_w_, battery_w_, settings_.pv_w_max));
    meter_check_.observe(
        {.utc_s = utc_s, .grid_w = grid_w_, .battery_w = battery_w_, .order = order});
  }

  /// Range of an order from `now_utc_s` on.
  [[nodiscard]] SiteRange range(std::int64_t now_utc_s, Margin margin) const {
    SiteRange range;
    limit_from_outside(now_utc_s, range);
    if (!has_meter()) return range;
    if (meter_check_.is_mismatch() && !settings_.idle_without_meter) return range;
    if (is_recent(now_utc_s)) {
      const std::int32_t trusted_w = limit_by_trust(now_utc_s, range);
      limit_at_connection_by_ratios(now_utc_s, margin, range);
      if (trusted_w != kAnyPowerW) range.relief_w = 0;
    } else if (settings_.idle_without_meter) {
      range.forbid(Reason::kMeterLost);
    }
    return range;
  }

  [[nodiscard]] SiteReport report(std::int64_t now_utc_s) const {
    SiteReport report{.meter_status = meter_status_, .limit_status = limit_status(now_utc_s)};
    if (!has_meter()) return report;
    report.has_grid_power = is_recent(now_utc_s);
    report.grid_power_w = report.has_grid_power ? grid_w_ : 0;
    const QuarterHourEnergy::Sums sums = energy_.at(now_utc_s);
    report.quarter_hour_import_wh = watt_hours(sums.import_ws);
    report.quarter_hour_battery_wh = watt_hours(sums.battery_ws);
    report.house_is_implausible = house_watch_.is_implausible();
    report.trust = meter_check_.trust();
    return report;
  }

 private:
  [[nodiscard]] bool has_meter() const { return settings_.meter != MeterSource::kNone; }

  static std::int32_t watt_hours(std::int64_t watt_seconds) {
    const std::int64_t wh =
        (watt_seconds + QuarterHourEnergy::kWsPerWh - 1) / QuarterHourEnergy::kWsPerWh;
    return static_cast<std::int32_t>(std::min<std::int64_t>(wh, INT32_MAX));
  }

  /// Limits `range` by the trust in the meter; returns that limit.
  std::int32_t limit_by_trust(std::int64_t now_utc_s, SiteRange& range) const {
    const std::int32_t power_w =
        settings_.idle_without_meter ? meter_check_.power_w_max(now_utc_s) : kAnyPowerW;
    range.limit_charge(power_w, Reason::kMeterMismatch);
    range.limit_discharge(power_w, Reason::kMeterMismatch);
    return power_w;
  }

  /// Applies the meter's reading, and its corrections by the ratios of the last steps.
  void limit_at_connection_by_ratios(std::int64_t now_utc_s, Margin margin,
                                     SiteRange& range) const {
    const std::int32_t margin_w = settings_.connection.margin_w;
    const std::int32_t kept_w = margin == Margin::kWhole ? margin_w : margin_w / 2;
    ConnectionState state{
        .grid_w = grid_w_, .battery_w = battery_w_, .quarter_hour = energy_.at(now_utc_s)};
    const MeterRatios ratios = meter_check_.possible_ratios(now_utc_s);
    // Ratio 1 is last: relief follows from the reading itself.
    for (const std::int32_t permille : {ratios.least_permille, ratios.most_permille, kTrueRatio}) {
      const std::int64_t grid_w = std::int64_t{grid_w_} * kTrueRatio / permille;
      state.grid_w =
          static_cast<std::int32_t>(std::clamp<std::int64_t>(grid_w, -kAnyPowerW, kAnyPowerW));
      limit_at_connection(settings_.connection, kept_w, state, range);
    }
  }

  /// After a clock step backwards readings are from the future: invalid too.
  [[nodiscard]] bool is_recent(std::int64_t now_utc_s) const {
    const std::int64_t age_s = now_utc_s - read_utc_s_;
    return age_s <= kMeterAgeMax_s && age_s >= -kMeterAgeMax_s;
  }

  Status read_meter(bool is_read, const BatteryMeasurement& battery, std::int32_t& grid_w) {
    if (settings_.meter == MeterSource::kMap) return meter_->read(grid_w);
    grid_w = battery.grid_power_w;
    if (!is_read) return Status::kNotConnected;
    return battery.has_grid_power ? Status::kOk : Status::kImplausible;
  }

  void read_outside_limits() {
    if (settings_.has_outside_limits) outside_status_ = outside_->read(limit_, is_limit_set_);
  }

  [[nodiscard]] Status limit_status(std::int64_t now_utc_s) const {
    if (!settings_.has_outside_limits || outside_status_ != Status::kOk) return outside_status_;
    const bool is_in_force = is_limit_set_ && now_utc_s < limit_.until_utc_s;
    return is_in_force || !settings_.idle_after_timeout ? Status::kOk : Status::kTimeout;
  }

  void limit_from_outside(std::int64_t now_utc_s, SiteRange& range) const {
    if (!settings_.has_outside_limits) return;
    if (limit_status(now_utc_s) != Status::kOk) return range.forbid(Reason::kOutsideLimit);
    if (!is_limit_set_ || now_utc_s >= limit_.until_utc_s) return;
    range.limit_charge(limit_.charge_w_max, Reason::kOutsideLimit);
    range.limit_discharge(limit_.discharge_w_max, Reason::kOutsideLimit);
  }

  SiteSettings settings_;
  Meter* meter_;
  OutsideLimits* outside_;
  MeterCheck meter_check_;
  HouseWatch house_watch_;
  QuarterHourEnergy energy_;
  std::int64_t read_utc_s_ = INT64_MIN / 2;  ///< of the newest good reading
  std::int32_t grid_w_ = 0;
  std::int32_t battery_w_ = 0;
  Status meter_status_ = Status::kOk;
  OutsideLimit limit_;
  bool is_limit_set_ = false;
  Status outside_status_ = Status::kOk;
};

}  // namespace bess
