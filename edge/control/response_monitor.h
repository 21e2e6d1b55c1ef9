// Does the battery do what it is told? Registers that read back as written prove only that they were
// stored: some batteries acknowledge and do nothing, a map with a wrong sign charges when it should
// discharge, and values can stand still while power flows. Pure integers, fed with every reading
// and the order that was in force, 0 W included.
//
//   what is seen                                      what follows
//   opposite direction; more power than ordered       trip: a person has to look
//   SoC that stands still or runs apart from power    trip
//   no power in the middle of the SoC                 pause: given back, tried again later
//   SoC that jumps                                    stop until readings agree again
//   less power than ordered, with no reason for it    told, not stopped
// Two readings make a finding. One that could not show a fault leaves its count as it is: a battery
// that goes the wrong way at every other order, with idle between, is found as well.
#pragma once

#include <cstdint>

#include "edge/base/response_band.h"
#include "edge/control/control_types.h"

namespace bess {

struct ResponseSettings {
  ResponseBand band;
  std::int32_t power_w = 4'000;      ///< rated
  std::int32_t capacity_wh = 8'000;  ///< where the device tells none
};

/// One reading, and the order that the battery followed when it was taken.
struct Response {
  std::int64_t utc_s = 0;
  bool is_driven = false;         ///< false: the battery is in its own mode, which goes any way
  std::int64_t order_number = 0;  ///< every order that was read back has its own
  std::int32_t ordered_power_w = 0;
  std::int32_t order_age_s = 0;          ///< since this power was ordered
  std::int32_t soc_floor_e4 = 1'000;     ///< where the device itself stops to discharge by it
  std::int32_t soc_ceiling_e4 = 10'000;  ///< and to charge
  BatteryMeasurement measurement;
};

class ResponseMonitor {
 public:
  static constexpr std::int32_t kReadingsToFind = 2;

  explicit ResponseMonitor(const ResponseSettings& settings) : settings_(settings) {}

  void observe(const Response& now);
  /// Between two readings that are judged, just before an order changes: counts what has flowed.
  void note_power(const Response& now);

  /// kWrongDirection, kUncontrolledPower or kSocMismatch once it is found; kStudent: nothing.
  [[nodiscard]] Reason trip() const { return trip_; }
  [[nodiscard]] bool gives_no_answer() const { return unexplained_ >= kReadingsToFind; }
  [[nodiscard]] bool has_jumped() const { return unsettled_readings_ > 0; }
  /// The newest reading showed power that an order asked for.
  [[nodiscard]] bool has_answered() const { return answers_; }
  /// Driven readings in a row with less power than ordered, and no reason for it.
  [[nodiscard]] std::int32_t weak_answers() const { return weak_answers_; }
  /// Driven readings in a row without any answer, explained or not.
  [[nodiscard]] std::int32_t unanswered_orders() const { return unanswered_orders_; }

  /// A person has looked, or a pause is over: counted anew from here.
  void forget();

 private:
  /// What flows within a span of time, in 1e-4 of the capacity, before losses.
  struct SocRange {
    std::int64_t least_e4 = 0;
    std::int64_t most_e4 = 0;
  };

  void judge_power(const Response& now);
  void judge_idle(std::int32_t measured_w);
  void judge_driven(const Response& now);
  void judge_soc(const Response& now);
  void judge_standstill(std::int32_t soc_e4, std::int64_t moved_e4);
  void judge_sum(std::int32_t soc_e4, const SocRange& range, std::int64_t slack_e4);
  void begin_standstill();
  void begin_sum(std::int32_t soc_e4);
  void count(std::int32_t& readings, Reason reason);
  [[nodiscard]] std::int32_t noise_w() const;
  [[nodiscard]] std::int32_t tolerance_w(std::int32_t power_w) const;
  [[nodiscard]] std::int32_t reachable_power_w(const Response& now) const;
  [[nodiscard]] bool may_be_less(const Response& now) const;
  [[nodiscard]] std::int64_t flowed_ws(const Response& now) const;

  ResponseSettings settings_;
  Reason trip_ = Reason::kStudent;
  bool answers_ = false;
  std::int32_t opposed_ = 0;
  std::int32_t excessive_idle_ = 0;
  std::int32_t excessive_driven_ = 0;
  std::int32_t unexplained_ = 0;
  std::int32_t weak_answers_ = 0;
  std::int32_t unanswered_orders_ = 0;
  std::int32_t unsettled_readings_ = 0;

  bool has_before_ = false;
  Response before_;
  std::int64_t flowed_ws_ = 0;  ///< from then until `flow_utc_s_`, with `flow_power_w_` at its end
  std::int64_t flow_utc_s_ = 0;
  std::int32_t flow_power_w_ = 0;
  /// Moved by the measured power since the SoC last changed: now, and how far it went.
  SocRange still_range_;
  std::int64_t still_e4_ = 0;
  std::int32_t still_readings_ = 0;
  std::int32_t sum_soc_e4_ = 0;  ///< where the sum of the next two began
  SocRange sum_;
  std::int32_t sum_readings_ = 0;
  std::int32_t sum_apart_ = 0;
};

}  // namespace bess
