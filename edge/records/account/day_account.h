// A local day in one line: money, energy, cycles, interventions, from the decision log's records.
// Money is before fees, taxes and wear: what a contract takes of it says `bess-train log`.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "edge/core/control/control_types.h"
#include "shared/host/exchanged_days.h"
#include "shared/units_and_limits.h"

namespace bess {

// What one cycle moved and earned, by its record alone: an estimate, at the price decided on.

/// Grid side, positive is charged; nothing where nothing was measured.
constexpr double cycle_energy_wh(const CycleRecord& record) {
  return record.has_measurement ? record.measurement.power_w * kHoursPerStep : 0.0;
}

/// Nothing where there is no price. From 0: a cycle at rest has earned nothing, and not minus
/// nothing.
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

  /// A record of that day; the order does not matter.
  void add(const CycleRecord& record);
  /// Ticks of that day that have no record.
  void add_missing(std::int64_t cycles) { missing_cycles_ += static_cast<int>(cycles); }
  void set_exchanged(const ExchangedDay& exchanged) { exchanged_ = exchanged; }
  /// Takes another day in: of both together.
  void add(const DayAccount& other);

  [[nodiscard]] bool is_empty() const { return cycles_ == 0; }
  [[nodiscard]] std::int32_t local_day() const { return local_day_; }
  [[nodiscard]] double earned_eur() const { return money().earned_eur; }
  [[nodiscard]] double charged_kwh() const { return exchanged_.charged_wh / 1'000; }
  [[nodiscard]] double discharged_kwh() const { return exchanged_.discharged_wh / 1'000; }
  /// Of both together: while nobody looked, by the state of charge alone.
  [[nodiscard]] double unseen_kwh() const { return exchanged_.unseen_wh / 1'000; }
  [[nodiscard]] const QuarterHourMoney& money() const { return exchanged_.money; }
  [[nodiscard]] double full_cycles() const;
  [[nodiscard]] int cycles() const { return cycles_; }
  [[nodiscard]] int missing_cycles() const { return missing_cycles_; }
  /// In which the battery followed an order, 0 W included.
  [[nodiscard]] int driven_cycles() const { return driven_cycles_; }
  /// 0 to 1, of the ticks, those without a record included.
  [[nodiscard]] double driven_share() const;
  /// Of `cycles`, with a measurement and a price.
  [[nodiscard]] int valued_cycles() const { return valued_cycles_; }
  /// State of charge when it was first and last measured, percent; NaN: never.
  [[nodiscard]] double first_soc_percent() const;
  [[nodiscard]] double last_soc_percent() const;
  /// More (negative: less) is stored at the end than at the beginning; 0 where it was not measured.
  [[nodiscard]] double stored_kwh() const;
  /// That as if it was sold at once, or bought, at the mean price, with the losses of [SPEC 3].
  [[nodiscard]] double stored_eur() const;
  [[nodiscard]] const CyclesByReason& cycles_by_reason() const { return cycles_by_reason_; }
  /// Of these, with the battery at 0 W or in its own mode.
  [[nodiscard]] const CyclesByReason& not_driven_by_reason() const { return not_driven_; }
  [[nodiscard]] int interventions() const;
  /// Local midnight, at which the day begins; 23, 24 or 25 hours before the next.
  [[nodiscard]] std::int64_t start_utc_s() const;
  /// "2023-11-26".
  [[nodiscard]] std::string date() const;
  /// "price_age 12, soc_empty 3": what ordered something else than the student.
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
