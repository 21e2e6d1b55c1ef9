// Accounts of local days, from the decision log: money, energy, full cycles, interventions. Money
// is before fees, taxes and wear, which `bess-train log` subtracts. Earnings as text, CSV and JSON:
// each quarter-hour counts at its settled price, or, as an estimate, at its last indicative price.
// The change in stored energy is valued at the mean price, because a day that ends empty has sold
// energy that another day bought.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "edge/core/control/control_types.h"
#include "edge/records/account/settled_prices.h"
#include "edge/records/log/log_reader.h"
#include "shared/host/exchange.h"
#include "shared/host/json.h"
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

/// Local days, both ends included, as 20231126.
struct Period {
  std::int32_t first_day = 0;
  std::int32_t last_day = 0;
  friend constexpr bool operator==(const Period&, const Period&) = default;
};

/// Parses today, yesterday, week, month, last-month, 2026-11, 2026-11-23 or
/// 2026-11-01..2026-11-23. A week begins on Monday; week and month end today. False for other texts
/// and for an end before the begin.
bool parse_period(std::string_view text, std::int32_t today, Period& period);

/// False for a record without a measurement.
bool sample_of(const CycleRecord& record, ExchangeSample& sample);

/// Sorts records into the accounts of their days.
class DayAccounts {
 public:
  /// Days from `first_day` to `last_day`, as 20231126. Records of other days count only for the
  /// energy at both ends.
  DayAccounts(std::int32_t first_day, std::int32_t last_day, const MoneyTerms& terms)
      : first_day_(first_day),
        last_day_(last_day),
        capacity_wh_(terms.capacity_wh),
        prices_(terms.settled.quarters()) {}

  /// Oldest record first.
  void add(const CycleRecord& as_logged);
  /// Days with a control cycle, oldest first.
  [[nodiscard]] std::vector<DayAccount> accounts() const;

 private:
  std::int32_t first_day_;
  std::int32_t last_day_;
  std::int32_t capacity_wh_;
  QuarterPrices prices_;
  std::map<std::int32_t, DayAccount> days_;
  std::int64_t last_utc_s_ = INT64_MAX;  ///< newest control cycle of these days
  std::vector<ExchangeSample> samples_;
};

/// Days from `first_day` to `last_day` with a control cycle in the log, oldest first.
std::vector<DayAccount> accounts_of_days(const LogReader& log, std::int32_t first_day,
                                         std::int32_t last_day, const MoneyTerms& terms);

// Of days, oldest first; may be empty.

DayAccount sum_of(const std::vector<DayAccount>& days);
std::string earnings_text(const std::vector<DayAccount>& days);
std::string earnings_csv(const std::vector<DayAccount>& days);
Json earnings_json(const std::vector<DayAccount>& days);

}  // namespace bess
