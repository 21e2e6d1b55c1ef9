// Response monitor: does the battery follow its set point? A read-back proves only that registers
// were stored: some batteries acknowledge and do nothing, a map with a wrong sign charges instead
// of discharging, and values can freeze while power flows. Pure integers, updated with every
// reading and the order in force, 0 W included.
//
//   observation                                       consequence
//   opposite direction; more power than ordered       trip until a person clears it
//   SoC constant, or not matching the power           trip (SocMonitor)
//   no power in the middle of the SoC range           pause: released, retried later
//   charging by itself near empty, balancing at full  pause: self-protection
//   jump of the SoC                                   stop until readings agree again
//   less power than ordered, missing energy, loss at  reported as a warning
//   0 W, a slow ramp, own limits that permit nothing
//
// Each kind of fault has its own counts (leaky_count.h), so that intermittent faults are found
// soon; rarer ones are found by their energy (energy_balance.h). A reading that could not show a
// fault leaves its count unchanged: wrong direction at every other order, idle between, is found
// too.
#pragma once

#include <cstdint>
#include <optional>

#include "edge/core/control/control_types.h"
#include "edge/core/supervision/energy_balance.h"
#include "edge/core/supervision/leaky_count.h"
#include "edge/core/supervision/response.h"

namespace bess {

// SoC monitor: state of charge against measured power, reading by reading.
//
//   constant while power flows; does not match it over a longer span        contradiction
//   changes suddenly by more than power explains                            jump: recalibrated
//   shows another share of the energy, or loses some at rest                warning
//                                                                           (energy_balance.h)
// Near the ends the SoC may stick and be recalibrated: charging above 95 % and discharging below
// 10 % explain a constant SoC or a larger change than power. Only these: discharging at 97 %, it
// must fall. And only for as much energy as a correct SoC can be wrong by.

class SocMonitor {
 public:
  explicit SocMonitor(const ResponseSettings& settings);

  void observe(const Response& now);
  /// Between two judged readings, just before an order changes: adds the energy.
  void note_cut(const Response& now);

  /// The SoC does not match this battery's energy.
  [[nodiscard]] bool contradicts() const { return contradicts_; }
  /// It changed by more than power explains, and readings have not yet agreed again.
  [[nodiscard]] bool has_jumped() const { return unsettled_readings_ > 0; }
  [[nodiscard]] const EnergyBalance::Findings& balance() const { return balance_.findings(); }

 private:
  /// Possible SoC change due to the power of an interval, in 1e-4 of the capacity.
  struct Flow {
    std::int64_t energy_e4 = 0;       ///< each reading's power since its order
    std::int64_t late_energy_e4 = 0;  ///< with the largest delay of power and SoC
    std::int64_t least_e4 = 0;        ///< SoC change within losses and capacity error
    std::int64_t most_e4 = 0;
  };

  [[nodiscard]] Flow flow_until(const Response& now) const;
  [[nodiscard]] std::int64_t measured_energy_ws(const Response& now, std::int64_t delay_s) const;
  [[nodiscard]] std::int64_t late_ws(const Response& now) const;
  [[nodiscard]] EnergyInterval interval_of(const Response& now, const Flow& flow) const;
  [[nodiscard]] std::int64_t e4_of(std::int64_t energy_ws) const;
  [[nodiscard]] bool rests(const Response& reading) const;
  [[nodiscard]] std::int32_t soc_step_e4() const;
  [[nodiscard]] std::int32_t soc_span_e4() const;
  [[nodiscard]] std::int64_t surely_moved_e4(const Flow& flow, std::int64_t seconds) const;
  bool is_excused(const Response& now, const Flow& flow, std::int64_t change_e4);
  bool is_beyond_its_end(std::int32_t soc_e4, const Flow& flow, std::int64_t change_e4);
  bool judge_jump(const Response& now, const Flow& flow, std::int64_t change_e4);
  [[nodiscard]] std::int64_t must_show_e4() const;
  void note_power(const Response& now);
  void judge_balance(const EnergyInterval& interval);
  void check_sparse_soc(const Response& now, bool excused);
  void judge_standstill(const Response& now, const Flow& flow, bool excused);
  void reset_from(const Response& now);

  ResponseSettings settings_;
  EnergyBalance balance_;
  SparseSocCheck sparse_soc_;  ///< instead of every reading, for a sparse SoC
  bool contradicts_ = false;

  bool has_before_ = false;
  Response before_;
  std::int64_t capacity_wh_ = 1;
  std::int64_t measured_energy_ws_ = 0;  ///< from `before_` until `flow_s_`
  std::int64_t late_ws_ = 0;             ///< the same, as late as permitted
  std::int64_t flow_s_ = 0;
  std::int32_t flow_power_w_ = 0;  ///< at `flow_s_`

  std::int32_t shown_step_e4_ = 0;  ///< greatest common divisor of the SoC values; 0 = none yet
  std::int32_t unsettled_readings_ = 0;
  LeakyCount jumps_;                ///< under power; at rest a recalibration is possible
  std::int64_t excused_e4_ = 0;     ///< at this end, since it was reached
  std::int64_t beyond_end_e4_ = 0;  ///< remainder beyond an end after a jump onto it
  /// Energy since the SoC last changed: now, and its extremes.
  std::int64_t still_e4_ = 0;
  std::int64_t still_least_e4_ = 0;
  std::int64_t still_most_e4_ = 0;
  std::int64_t still_total_e4_ = 0;  ///< absolute sum
  std::int32_t still_readings_ = 0;
};

/// Count per sign of the order: a fault may affect one sign only, and correct responses to the
/// other do not forgive it.
class DirectedCount {
 public:
  void bad(bool is_charging) {
    of_all_.bad();
    of(is_charging).bad();
  }
  void good(bool is_charging) {
    of_all_.good();
    of(is_charging).good();
  }
  [[nodiscard]] bool is_found() const {
    return of_all_.is_found() || of_charging_.is_found() || of_discharging_.is_found();
  }

 private:
  LeakyCount& of(bool is_charging) { return is_charging ? of_charging_ : of_discharging_; }

  LeakyCount of_all_;
  LeakyCount of_charging_;
  LeakyCount of_discharging_;
};

class ResponseMonitor {
 public:
  explicit ResponseMonitor(const ResponseSettings& settings)
      : settings_(settings), soc_(settings) {}

  void observe(const Response& now);
  /// Between two judged readings, just before an order changes: adds the energy.
  void note_power(const Response& now) { soc_.note_cut(now); }
  /// Any other reading in between: adds wrong energy only.
  void note_between(const Response& now);

  /// kWrongDirection, kUncontrolledPower or kSocMismatch once found.
  [[nodiscard]] std::optional<Reason> trip() const { return trip_; }
  [[nodiscard]] bool gives_no_answer() const { return unexplained_.is_found(); }
  /// Charges without an order when nearly empty, or balances its full cells.
  [[nodiscard]] bool looks_after_itself() const { return care_.is_found(); }
  /// The newest reading has shown no self-protection.
  [[nodiscard]] bool needs_no_care() const { return needs_no_care_; }
  [[nodiscard]] bool has_jumped() const { return soc_.has_jumped(); }
  /// The newest reading showed power as ordered.
  [[nodiscard]] bool has_answered() const { return answers_; }
  /// Consecutive driven readings with less power than ordered, without an explanation.
  [[nodiscard]] std::int32_t weak_answers() const { return weak_answers_; }
  /// Consecutive driven readings without any response, explained or not.
  [[nodiscard]] std::int32_t unanswered_orders() const { return unanswered_orders_; }
  /// Findings that are no reason to stop.
  [[nodiscard]] ResponseFindings findings() const;

  /// Counters restart after a manual clear.
  void clear() { *this = ResponseMonitor(settings_); }
  /// A pause begins: the same, but wrong energy is kept, since rare faults are rarer than pauses.
  void forget() {
    const WrongEnergy wrong_energy = wrong_energy_;
    clear();
    wrong_energy_ = wrong_energy;
  }
  /// Value of an earlier run, from its log.
  void restore(const ResponseFindings& logged) { wrong_energy_.restore(logged.wrong_energy_e6); }

 private:
  void count_locked(const BatteryMeasurement& m);
  void judge_power(const Response& now);
  void judge_idle(const Response& now);
  void judge_driven(const Response& now);
  void judge_answer(const Response& now, std::int32_t measured_w);
  void trip_if(bool is_found, Reason reason);
  void note_energy(const Response& now, std::int64_t wrong_w);
  void note_wrong(const Response& now, std::int64_t wrong_w, Reason reason);
  bool note_ramp(const Response& now, std::int32_t from_w);
  bool is_ramp(const Response& now);
  bool is_ramp_of_order_before(const Response& now);
  [[nodiscard]] bool knows_before(const Response& now) const;
  [[nodiscard]] bool is_new_order(const Response& now) const;
  [[nodiscard]] bool has_not_begun(const Response& now) const;
  [[nodiscard]] bool may_be_ramp(const Response& now) const;
  [[nodiscard]] bool is_care(const BatteryMeasurement& m) const;
  [[nodiscard]] std::int32_t reachable_power_w(const Response& now) const;
  [[nodiscard]] bool may_be_less(const Response& now) const;

  ResponseSettings settings_;
  SocMonitor soc_;
  std::optional<Reason> trip_;
  bool answers_ = false;
  bool needs_no_care_ = false;
  bool is_on_its_way_ = false;
  DirectedCount opposed_;
  DirectedCount excessive_driven_;
  DirectedCount unexplained_;
  LeakyCount excessive_idle_;
  LeakyCount care_;
  LeakyCount slow_;
  WrongEnergy wrong_energy_;       ///< faults too rare for the counts
  std::int32_t ramp_w_per_s_ = 0;  ///< largest of the responses still ramping
  std::int16_t locked_readings_ = 0;
  std::int32_t weak_answers_ = 0;
  std::int32_t unanswered_orders_ = 0;
  bool has_before_ = false;
  std::int64_t before_s_ = 0;
  std::int32_t before_power_w_ = 0;
  std::int32_t before_ordered_w_ = 0;
  bool before_may_be_less_ = false;  ///< its power may have been limited
  bool before_is_on_its_way_ = false;
};

}  // namespace bess
