// Consistency of a battery's readings: the state of charge must follow the measured power, and
// power the order. Detects wrong signs and scales of values within their ranges. Pure; for
// recordings, not for the control path (see supervision.h).
#pragma once

#include <cstdint>
#include <list>
#include <optional>
#include <vector>

#include "edge/device/battery/step_fit.h"
#include "edge/device/registers/point_values.h"
#include "edge/device/registers/register_map.h"
#include "shared/bus_exchange.h"

namespace bess {

/// Power steps of a recording: each order with the measured power until the next one, for
/// step_fit.h. Omits incomplete steps: started before the last was reached, limited, or read too
/// rarely.
class RecordedSteps {
 public:
  /// `unit` replaces the map's unit id if not negative; `time_scale` converts latencies from wall
  /// time to time of the recording. `map` must outlive this object.
  RecordedSteps(const RegisterMap& map, std::int32_t unit, std::int32_t time_scale);

  /// Adds every exchange of a recording, in order.
  void add(const BusExchange& exchange);

  /// Complete steps so far; valid as long as this object.
  [[nodiscard]] std::vector<const StepResponse*> whole() const;
  [[nodiscard]] int orders() const { return orders_; }  ///< that changed the power

 private:
  [[nodiscard]] std::int32_t band_w(std::int64_t order_w) const;
  void take_order(std::int64_t end_ns);
  void begin_step(std::int64_t order_w);
  void take_reading(std::int64_t begin_ns, std::int64_t end_ns);

  const RegisterMap& map_;
  PointPlaces places_;
  PointValues live_;
  std::int32_t time_scale_;
  int power_ = -1;                       ///< last point of the measured power
  std::optional<std::int64_t> order_w_;  ///< in force, if known
  std::optional<std::int64_t> power_w_;  ///< newest since then
  std::int64_t order_ns_ = 0;            ///< time of the order, or of its immediate repetition
  std::int64_t from_w_ = 0;              ///< measured before the step
  int sign_ = 1;
  std::list<StepResponse> curves_;
  StepResponse* step_ = nullptr;  ///< current
  int orders_ = 0;
};

/// Newest values at one time.
struct EnergyReading {
  std::int64_t utc_ns = 0;  ///< of the power
  std::int64_t power_w = 0;
  std::optional<std::int64_t> soc_e4;
  std::optional<std::int64_t> order_w;  ///< of the order in force
  std::int64_t order_age_s = 0;         ///< at least this long
};

class EnergyEvidence {
 public:
  /// `settle_s`: time until power follows an order.
  explicit EnergyEvidence(std::int32_t settle_s) : settle_s_(settle_s) {}

  void add(const EnergyReading& reading);

  /// Change of the state of charge relative to the measured energy: 1 if correct, negative with a
  /// wrong sign. Empty with less than three SoC changes. `capacity_wh` above 0.
  [[nodiscard]] std::optional<double> soc_per_energy(double capacity_wh) const;
  /// Energy has flowed without any change of the state of charge.
  [[nodiscard]] bool soc_stands_still(double capacity_wh) const;
  [[nodiscard]] double energy_moved_wh() const { return energy_moved_wh_; }

  enum class Answer { kUnknown, kFollows, kOpposite };
  [[nodiscard]] Answer answer() const;
  /// Ratio of measured to ordered power; empty without comparable readings.
  [[nodiscard]] std::optional<double> power_per_order() const;

 private:
  void balance(const EnergyReading& reading, double energy_wh);
  void compare(const EnergyReading& reading);

  std::int32_t settle_s_;
  std::int64_t last_utc_ns_ = 0;
  double energy_wh_ = 0;        ///< since the SoC changed last; charging is positive
  double energy_moved_wh_ = 0;  ///< charged plus discharged
  std::optional<std::int64_t> soc_e4_;
  int soc_changes_ = 0;
  double soc_times_energy_ = 0, energy_squared_ = 0;  ///< sums over the changes
  int same_way_ = 0, other_way_ = 0;
  double measured_w_ = 0, ordered_w_ = 0;  ///< sums of magnitudes
};

}  // namespace bess
