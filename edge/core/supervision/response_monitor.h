// Does the battery do what it is told? Registers that read back as written prove only that they
// were stored: some batteries acknowledge and do nothing, a map with a wrong sign charges when it
// should discharge, and values can stand still while power flows. Pure integers, fed with every
// reading and the order that was in force, 0 W included.
//
//   what is seen                                      what follows
//   opposite direction; more power than ordered       trip: a person has to look
//   SoC that stands still or runs apart from power    trip (soc_monitor.h)
//   no power in the middle of the SoC                 pause: given back, tried again later
//   charging by itself near empty, balancing at full  pause: a battery looks after itself
//   SoC that jumps                                    stop until readings agree again
//   less power than ordered, energy that does not     told, not stopped
//   arrive, loss at 0 W, a slow ramp, limits of
//   its own that allow nothing
// Each kind of fault has counts of its own (leaky_count.h), so that one that comes and goes is
// found soon; what is too rare for them is found by its energy (energy_balance.h). A reading that
// could not show a fault leaves its count as it is: a battery that goes the wrong way at every
// other order, with idle between, is found as well.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "edge/core/base/response_band.h"
#include "edge/core/control/control_types.h"
#include "edge/core/supervision/energy_balance.h"
#include "edge/core/supervision/leaky_count.h"
#include "edge/core/supervision/response.h"
#include "edge/core/supervision/soc_monitor.h"

namespace bess {

/// Of a fault that may be of orders of one sign alone: right answers to the others do not forgive
/// it.
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
  /// Between two readings that are judged, just before an order changes: counts what has flowed.
  void note_power(const Response& now) { soc_.note_cut(now); }
  /// Any other between the two: counts what has flowed wrongly, and nothing else.
  void note_between(const Response& now);

  /// kWrongDirection, kUncontrolledPower or kSocMismatch once it is found.
  [[nodiscard]] std::optional<Reason> trip() const { return trip_; }
  [[nodiscard]] bool gives_no_answer() const { return unexplained_.is_found(); }
  /// It charges although it is nearly empty and was not told to, or balances its full cells.
  [[nodiscard]] bool looks_after_itself() const { return care_.is_found(); }
  /// The newest reading has shown that it does not.
  [[nodiscard]] bool needs_no_care() const { return needs_no_care_; }
  [[nodiscard]] bool has_jumped() const { return soc_.has_jumped(); }
  /// The newest reading showed power that an order asked for.
  [[nodiscard]] bool has_answered() const { return answers_; }
  /// Driven readings in a row with less power than ordered, and no reason for it.
  [[nodiscard]] std::int32_t weak_answers() const { return weak_answers_; }
  /// Driven readings in a row without any answer, explained or not.
  [[nodiscard]] std::int32_t unanswered_orders() const { return unanswered_orders_; }
  /// Found, and short of a reason to stop.
  [[nodiscard]] ResponseFindings findings() const;

  /// A person has looked: counted anew from here.
  void clear() { *this = ResponseMonitor(settings_); }
  /// A pause begins: the same, but that rare faults are rarer than pauses.
  void forget() {
    const WrongEnergy wrong_energy = wrong_energy_;
    clear();
    wrong_energy_ = wrong_energy;
  }
  /// Of an earlier run, by its log.
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
  WrongEnergy wrong_energy_;       ///< what comes too seldom for the counts
  std::int32_t ramp_w_per_s_ = 0;  ///< the most of answers that were still on their way
  std::int16_t locked_readings_ = 0;
  std::int32_t weak_answers_ = 0;
  std::int32_t unanswered_orders_ = 0;
  bool has_before_ = false;
  std::int64_t before_s_ = 0;
  std::int32_t before_power_w_ = 0;
  std::int32_t before_ordered_w_ = 0;
  bool before_may_be_less_ = false;  ///< it may have held back what it was ordered
  bool before_is_on_its_way_ = false;
};

}  // namespace bess
