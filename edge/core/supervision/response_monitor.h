// Response monitor: does the battery follow its set point? A read-back proves only that registers
// were stored: some batteries acknowledge and do nothing, a map with a wrong sign charges instead
// of discharging, and values can freeze while power flows. Pure integers, updated with every
// reading and the order in force, 0 W included.
//
//   observation                                       consequence
//   opposite direction; more power than ordered       trip until a person clears it
//   SoC constant, or not matching the power           trip (soc_monitor.h)
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
#include "edge/core/supervision/soc_monitor.h"

namespace bess {

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
