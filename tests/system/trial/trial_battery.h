// Battery of the trial behind the control loop's battery interface: cells, a power stage and a
// battery management that counts, shows and errs, in steps of 1 s. Written from the behaviour of
// batteries, independently of tools/simulators/battery_sim and its errors. Faults change the real
// or the shown power.
#pragma once

#include <cstdint>
#include <random>

#include "edge/core/control/control_types.h"
#include "edge/core/control/power_order.h"
#include "tests/system/trial/healthy_batteries.h"
#include "tests/system/trial/trial_clock.h"
#include "tests/system/trial/trial_fault.h"

namespace bess::trial {

/// Since the start, in the cells.
struct EnergyAccount {
  double moved_wh = 0;  ///< in and out, at the grid side
  double wrong_wh = 0;  ///< against the flow of a healthy battery, or beyond order and it
};

class TrialBattery {
 public:
  TrialBattery(TrialClock& clock, const BatteryNature& nature, double soc_frac, std::uint64_t seed);

  // The control loop's interface.
  Status read(BatteryMeasurement& measurement);
  Status order(const PowerOrder& order);
  Status release();
  Status refresh() { return Status::kOk; }
  [[nodiscard]] std::int32_t refresh_interval_s() const { return 0; }
  [[nodiscard]] BatteryCounters counters() const { return {}; }

  /// From the next tick on; `fault` outlives this object.
  void begin_fault(const TrialFault& fault, const FaultTimes& times, std::int64_t first_tick_utc_s);

  /// Up to the clock's now.
  void advance();
  [[nodiscard]] const EnergyAccount& energy() const { return energy_; }
  [[nodiscard]] double charge_frac() const { return charge_frac_; }

 private:
  void step();
  void restart_at_times();
  void follow_command();
  void account();
  void count_charge();
  void calibrate();
  [[nodiscard]] double command_w() const;
  [[nodiscard]] double own_mode_w() const;
  [[nodiscard]] double sun_w() const;
  [[nodiscard]] double within_limits(double power_w) const;
  [[nodiscard]] double charge_limit_w() const;
  [[nodiscard]] double discharge_limit_w() const;
  [[nodiscard]] double derated_w() const;
  [[nodiscard]] double temperature_c() const;
  [[nodiscard]] double hour_of_day() const;
  [[nodiscard]] double counted_frac() const;
  [[nodiscard]] double overridden_w(double power_w);
  [[nodiscard]] bool is_faulty();
  void note_fault_begin();
  void show();
  [[nodiscard]] std::int32_t shown_soc_e4();
  [[nodiscard]] BatteryMeasurement honest_display();
  bool answers_late();

  TrialClock& clock_;
  BatteryNature nature_;
  std::mt19937_64 random_;
  std::int64_t now_s_;

  double charge_frac_;       ///< of the cells
  double count_error_frac_;  ///< error of the management's count
  double target_error_frac_ = 0;
  int calibration_day_ = -1;
  std::int64_t resting_s_ = 0;
  double surface_frac_ = 0;  ///< error since the last charge, settling at rest

  bool is_dispatched_ = false;
  double ordered_w_ = 0;
  double ordered_before_w_ = 0;
  std::int64_t ordered_s_ = 0;
  double floor_frac_ = 0;
  double ceiling_frac_ = 1;
  std::int64_t dispatch_end_s_ = 0;

  double followed_w_ = 0;  ///< the newest command, the target after its lag
  std::int64_t followed_from_s_ = 0;
  double target_w_ = 0;
  double stage_w_ = 0;  ///< of the power stage, on its ramp
  double wander_ = 0;   ///< current noise, relative
  double flow_w_ = 0;
  double honest_w_ = 0;
  bool is_forced_ = false;
  std::int64_t next_restart_s_ = INT64_MAX;
  std::int64_t back_s_ = 0;

  BatteryMeasurement shown_;

  const TrialFault* fault_ = nullptr;
  FaultTimes times_;
  std::int64_t fault_tick_s_ = 0;
  std::int64_t fault_since_s_ = 0;
  std::int64_t drawn_tick_ = -1;
  bool drawn_ = false;
  bool was_faulty_ = false;
  double ordered_at_fault_w_ = 0;
  double charge_at_fault_frac_ = 0;
  BatteryMeasurement shown_at_fault_;

  EnergyAccount energy_;
};

}  // namespace bess::trial
