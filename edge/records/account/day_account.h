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

class DayAccount {
 public:
  /// `local_day` as 20231126 (local_time.h).
  explicit DayAccount(std::int32_t local_day) : local_day_(local_day) {}

  /// Adds a record of that day, in any order.
  void add(const CycleRecord& record);
  /// Adds ticks of that day without a record.
  void add_missing(std::int64_t cycles) { missing_cycles_ += static_cast<int>(cycles); }
  void set_exchanged(const ExchangedDay& exchanged) { exchanged_ = exchanged; }
  /// Adds another day.
  void add(const DayAccount& other);

  [[nodiscard]] bool is_empty() const { return cycles_ == 0; }
  [[nodiscard]] double earned_eur() const { return money().earned_eur; }
  [[nodiscard]] double charged_kwh() const { return exchanged_.charged_wh / 1'000; }
  [[nodiscard]] double discharged_kwh() const { return exchanged_.discharged_wh / 1'000; }
  /// Charged and discharged without a measurement, estimated from the SoC.
  [[nodiscard]] double unseen_kwh() const { return exchanged_.unseen_wh / 1'000; }
  [[nodiscard]] const QuarterHourMoney& money() const { return exchanged_.money; }
  [[nodiscard]] double full_cycles() const;
  [[nodiscard]] int cycles() const { return cycles_; }
  [[nodiscard]] int missing_cycles() const { return missing_cycles_; }
  /// Control cycles with an order in force, 0 W included.
  [[nodiscard]] int driven_cycles() const { return driven_cycles_; }
  /// Share of all ticks, 0 to 1, those without a record included.
  [[nodiscard]] double driven_share() const;
  /// Control cycles with a measurement and a price.
  [[nodiscard]] int valued_cycles() const { return valued_cycles_; }
  /// First and last measured state of charge, percent; NaN = none.
  [[nodiscard]] double first_soc_percent() const;
  [[nodiscard]] double last_soc_percent() const;
  /// Change in stored energy over the day; 0 without a measurement.
  [[nodiscard]] double stored_kwh() const;
  /// Its value at the mean price, with the losses of [SPEC 3].
  [[nodiscard]] double stored_eur() const;
  [[nodiscard]] const CyclesByReason& cycles_by_reason() const { return cycles_by_reason_; }
  /// Of these, outside mode running.
  [[nodiscard]] const CyclesByReason& not_driven_by_reason() const { return not_driven_; }
  [[nodiscard]] int interventions() const;
  /// Local midnight at the start of the day.
  [[nodiscard]] std::int64_t start_utc_s() const;
  /// "2023-11-26".
  [[nodiscard]] std::string date() const;
  /// "price_age 12, soc_empty 3": reasons other than the student.
  [[nodiscard]] std::string interventions_text() const;
  [[nodiscard]] std::string line() const;

 private:
  struct Charge {
    std::int64_t utc_s = 0;
    std::int32_t soc_e4 = 0;
  };
  [[nodiscard]] bool has_soc() const { return first_.utc_s != INT64_MAX; }

  std::int32_t local_day_;
  ExchangedDay exchanged_{};
  std::int32_t soc_moved_e4_ = 0;
  int cycles_ = 0;
  int missing_cycles_ = 0;
  int driven_cycles_ = 0;
  int valued_cycles_ = 0;
  Charge first_{INT64_MAX, 0}, last_{INT64_MIN, 0};
  std::int32_t capacity_wh_ = 0;  ///< newest
  CyclesByReason cycles_by_reason_{}, not_driven_{};
};

}  // namespace bess
