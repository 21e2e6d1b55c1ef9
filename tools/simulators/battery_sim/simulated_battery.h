// Physics and dispatch of the simulated battery, without a bus: event-driven and exact. Between two
// events (new order, expiry, minute boundary) the power is constant, so one battery_step per
// segment integrates without error at any time scale. With a ramp, lag, taper or habit a segment is
// 1 s or 0.05 s.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/battery_model.h"

namespace bess {

/// One minute of the battery trace.
struct MinuteRecord {
  std::int64_t minute_utc_s;
  double energy_wh;          ///< grid side, charge positive
  double soc_frac;           ///< at the end of the minute
  double commanded_power_w;  ///< at the end of the minute; 0 without a dispatch
};

/// Event of the order in force.
struct DispatchEvent {
  enum class Kind : std::uint8_t {
    kOrder,   ///< written, or written again
    kStop,    ///< released by a master
    kExpiry,  ///< not refreshed in time
  };
  std::int64_t utc_ns = 0;
  Kind kind = Kind::kOrder;
  double power_w = 0;           ///< grid side, charge positive; 0 unless an order
  std::int64_t duration_s = 0;  ///< until its expiry; 0 unless an order
  double soc_frac = 0;
};

/// Deviations from an ideal battery. The defaults are ideal.
struct BatteryHabits {
  double gain = 1;                 ///< share of the ordered power that flows
  double idle_power_w = 0;         ///< flows, whatever the SoC, while 0 W is ordered
  double delay_s = 0;              ///< from a new order to its power
  double noise_frac = 0;           ///< standard deviation of the power, drawn each minute
  bool slows_near_limits = false;  ///< a quarter of the power within 5 % of a limit
  double ramp_w_per_s = 0;         ///< of its power while it follows orders; 0: immediate
  double hidden_drain_w = 0;       ///< unmetered discharge of the cells
  double forced_charge_w = 0;      ///< from below 10 % up to 11 %, whatever the order
  double balancing_w = 0;          ///< dissipated while it is full
};

class SimulatedBattery {
 public:
  SimulatedBattery(const BatteryParameters& parameters, double soc_frac, std::int64_t utc_ns);

  /// Integrates up to `utc_ns`; an instant in the past changes nothing.
  void advance(std::int64_t utc_ns);

  /// `power_w` until the SoC limit (maximum when charging, minimum when discharging) or for
  /// `duration_s`; then the battery's own mode, modelled as 0 W. Call `advance` first.
  void start_dispatch(double power_w, double soc_limit_frac, std::int64_t duration_s);
  void stop_dispatch();

  void set_habits(const BatteryHabits& habits) { habits_ = habits; }
  /// Share of the rated power available, by temperature; the battery displays it.
  void set_derating(double power_frac) { derating_ = power_frac; }
  [[nodiscard]] double derating() const { return derating_ * cold_share(); }
  /// First-order lag after delay and ramp; 0: immediate.
  void set_time_constant(double seconds) { parameters_.response.time_constant_s = seconds; }

  [[nodiscard]] bool dispatch_active() const { return dispatch_active_; }
  [[nodiscard]] double soc_frac() const { return soc_frac_; }
  [[nodiscard]] double power_w() const;  ///< flowing now
  /// Of the order in force; 0 without one.
  [[nodiscard]] double commanded_power_w() const { return dispatch_active_ ? power_w_ : 0.0; }
  [[nodiscard]] const BatteryParameters& parameters() const { return parameters_; }

  /// Completed minutes, and the current one last.
  [[nodiscard]] std::vector<MinuteRecord> record() const;
  /// All orders, stops and expiries since the start, ascending.
  [[nodiscard]] const std::vector<DispatchEvent>& dispatch_events() const { return events_; }

 private:
  void note(DispatchEvent::Kind kind, double power_w = 0, std::int64_t duration_s = 0);
  [[nodiscard]] double cold_share() const;
  [[nodiscard]] BatteryParameters limited() const;
  [[nodiscard]] bool changes_by_the_second() const;
  [[nodiscard]] bool is_lagging() const;
  [[nodiscard]] double ramp_w_per_s() const;
  void follow_habits(double seconds);
  [[nodiscard]] double wanted_power_w() const;
  [[nodiscard]] double ordered_flow_w() const;
  [[nodiscard]] double burnt_w() const;
  [[nodiscard]] double noise_factor() const;
  [[nodiscard]] MinuteRecord current_minute() const;
  void integrate_segment(std::int64_t end_ns);

  BatteryParameters parameters_;
  double soc_frac_;
  std::int64_t now_ns_;
  bool dispatch_active_ = false;
  BatteryHabits habits_{};
  double derating_ = 1;
  double power_w_ = 0;
  double power_before_w_ = 0;  ///< flows until `change_ns_`
  std::int64_t change_ns_ = 0;
  double ramped_w_ = 0;              ///< power after the ramp
  double lagged_w_ = 0;              ///< power after ramp and lag
  bool is_charging_itself_ = false;  ///< forced charge
  double soc_limit_frac_ = 1;
  std::int64_t dispatch_end_ns_ = 0;
  double minute_energy_wh_ = 0;
  std::vector<MinuteRecord> minutes_;
  std::vector<DispatchEvent> events_;
};

}  // namespace bess
