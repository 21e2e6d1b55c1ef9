// Account of a local day from the decision log: money, energy, full cycles, interventions. Money is
// before fees, taxes and wear, which `bess-train log` subtracts.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "edge/core/control/control_types.h"
#include "shared/host/exchange.h"
#include "shared/units_and_limits.h"

namespace bess {

// Energy and money of one control cycle, an estimate from its record at the price of the decision.

/// Grid side, positive is charged; 0 without a measurement.
constexpr double cycle_energy_wh(const CycleRecord& record) {
  return record.has_measurement ? record.measurement.power_w * kHoursPerStep : 0.0;
}

/// 0 without a price. Subtracted from 0 to avoid -0 for an idle battery.
constexpr double cycle_earned_eur(const CycleRecord& record) {
  if (!record.price.has_row) return 0.0;
  return 0.0 - cycle_energy_wh(record) / kWattsPerMegawatt * record.price.price_centi_eur_per_mwh /
                   kCentiPerEur;
}

using CyclesByReason = std::array<int, kReasonCount>;

/// Local midnight at the start of a day such as 20231126.
std::int64_t local_day_start_utc_s(std::int32_t local_day);
/// "2023-11-26".
std::string local_day_text(std::int32_t local_day);

/// Sum of records, days or both.
struct DayAccount {
  struct Charge {
    std::int64_t utc_s = 0;
    std::int32_t soc_e4 = 0;
  };

  std::int32_t local_day = 0;  ///< as 20231126 (local_time.h)
  ExchangedDay exchanged{};
  std::int32_t soc_moved_e4 = 0;
  int cycles = 0;
  int missing_cycles = 0;  ///< ticks without a record
  int driven_cycles = 0;   ///< control cycles with an order in force, 0 W included
  int valued_cycles = 0;   ///< control cycles with a measurement and a price
  Charge first{INT64_MAX, 0}, last{INT64_MIN, 0};
  std::int32_t capacity_wh = 0;  ///< newest
  CyclesByReason cycles_by_reason{};
  CyclesByReason not_driven_by_reason{};  ///< of these, outside mode running

  /// Adds a record of that day, in any order.
  void add(const CycleRecord& record);
  /// Adds another day.
  void add(const DayAccount& other);

  [[nodiscard]] double charged_kwh() const { return exchanged.charged_wh / 1'000; }
  [[nodiscard]] double discharged_kwh() const { return exchanged.discharged_wh / 1'000; }
  /// Charged and discharged without a measurement, estimated from the SoC.
  [[nodiscard]] double unseen_kwh() const { return exchanged.unseen_wh / 1'000; }
  [[nodiscard]] double full_cycles() const;
  /// Share of all ticks, 0 to 1, those without a record included.
  [[nodiscard]] double driven_share() const;
  /// First and last measured state of charge, percent; NaN = none.
  [[nodiscard]] double first_soc_percent() const;
  [[nodiscard]] double last_soc_percent() const;
  /// Change in stored energy over the day; 0 without a measurement.
  [[nodiscard]] double stored_kwh() const;
  /// Its value at the mean price, with the losses of [SPEC 3].
  [[nodiscard]] double stored_eur() const;
  [[nodiscard]] int interventions() const;
  /// "price_age 12, soc_empty 3": reasons other than the student.
  [[nodiscard]] std::string interventions_text() const;
  [[nodiscard]] std::string line() const;
  [[nodiscard]] bool has_soc() const { return first.utc_s != INT64_MAX; }
};

}  // namespace bess
