// A local day in one line: money, energy, cycles, interventions, from the decision log's records.
// Integers until they are written.
//
// A record's power was measured 3 s before its tick, and its price is of the minute before it: both
// stand for the two minutes that end there. The money is an estimate: the measured power of one
// instant, at the indicative price, without the settlement of the quarter-hour, fees or taxes.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "edge/control/control_types.h"

namespace bess {

using CyclesByReason = std::array<int, kReasonCount>;
/// "price_age 12, soc_empty 3": what ordered something else than the student.
std::string interventions_text(const CyclesByReason& cycles);

class DayAccount {
 public:
  /// `local_day` as 20231126 (cycle_budget.h).
  explicit DayAccount(std::int32_t local_day) : local_day_(local_day) {}

  /// A record of that day; the order does not matter.
  void add(const CycleRecord& record);

  [[nodiscard]] bool is_empty() const { return cycles_ == 0; }
  [[nodiscard]] std::int32_t local_day() const { return local_day_; }
  [[nodiscard]] double earned_eur() const;
  [[nodiscard]] double charged_kwh() const;
  [[nodiscard]] double discharged_kwh() const;
  [[nodiscard]] double full_cycles() const;
  [[nodiscard]] int cycles() const { return cycles_; }
  /// In which the battery followed an order, 0 W included.
  [[nodiscard]] int driven_cycles() const { return driven_cycles_; }
  /// Of `cycles`, with a measurement and a price: what the money is of.
  [[nodiscard]] int valued_cycles() const { return valued_cycles_; }
  /// Over those; 0 where there are none.
  [[nodiscard]] double mean_price_eur_per_mwh() const;
  /// State of charge when it was first and last measured, in 1e-4, and the newest capacity: false =
  /// never measured.
  [[nodiscard]] bool has_soc() const { return first_soc_utc_s_ != INT64_MAX; }
  [[nodiscard]] std::int32_t first_soc_e4() const { return first_soc_e4_; }
  [[nodiscard]] std::int32_t last_soc_e4() const { return last_soc_e4_; }
  [[nodiscard]] std::int32_t capacity_wh() const { return capacity_wh_; }
  [[nodiscard]] int cycles_with(Reason reason) const {
    return cycles_by_reason_[static_cast<std::size_t>(reason)];
  }
  [[nodiscard]] const CyclesByReason& cycles_by_reason() const { return cycles_by_reason_; }
  [[nodiscard]] int interventions() const;
  /// Local midnight, at which the day begins; 23, 24 or 25 hours before the next.
  [[nodiscard]] std::int64_t start_utc_s() const;
  /// "2023-11-26".
  [[nodiscard]] std::string date() const;
  [[nodiscard]] std::string line() const;

 private:
  void note_soc(const CycleRecord& record);

  std::int32_t local_day_;
  std::int64_t watt_centi_ = 0;  ///< sum of W times hundredths of EUR/MWh, over two minutes each
  std::int64_t charged_w_ = 0;   ///< sum of W, over two minutes each
  std::int64_t discharged_w_ = 0;
  std::int32_t soc_moved_e4_ = 0;
  int cycles_ = 0;
  int driven_cycles_ = 0;
  int valued_cycles_ = 0;
  std::int64_t price_centi_ = 0;  ///< sum over the valued cycles
  std::int64_t first_soc_utc_s_ = INT64_MAX;
  std::int64_t last_soc_utc_s_ = INT64_MIN;
  std::int32_t first_soc_e4_ = 0;
  std::int32_t last_soc_e4_ = 0;
  std::int32_t capacity_wh_ = 0;
  CyclesByReason cycles_by_reason_{};
};

}  // namespace bess
