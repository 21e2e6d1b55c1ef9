// A local day in one line: money, energy, cycles, interventions, from the decision log's records.
//
// What was earned is counted by quarter-hours, at the settled price where it is published, else at
// the last indicative one: that part is an estimate. What the contract adds stands beside it.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "edge/account/exchange.h"
#include "edge/control/control_types.h"

namespace bess {

using CyclesByReason = std::array<int, kReasonCount>;
/// "price_age 12, soc_empty 3": what ordered something else than the student.
std::string interventions_text(const CyclesByReason& cycles);

/// Money at the prices of whole quarter-hours (quarter_prices.h).
struct QuarterHourMoney {
  double earned_eur = 0;          ///< before the contract
  double estimated_eur = 0;       ///< of it, where nothing is published yet
  double contract_eur = 0;        ///< what the contract takes of it
  double prices_eur_per_mwh = 0;  ///< the sum of those that have one
  int quarter_hours = 0;          ///< of which the log knows something
  int published = 0;              ///< of those, the validated among them
  int validated = 0;
  int unpriced = 0;  ///< without any price: their energy is not in the money

  [[nodiscard]] double net_eur() const { return earned_eur - contract_eur; }
  /// 0 where none has a price.
  [[nodiscard]] double mean_price_eur_per_mwh() const;
  void add(const QuarterHourMoney& other);
};

class DayAccount {
 public:
  /// `local_day` as 20231126 (cycle_budget.h).
  explicit DayAccount(std::int32_t local_day) : local_day_(local_day) {}

  /// A record of that day; the order does not matter.
  void add(const CycleRecord& record);
  /// What flowed in it.
  void add(const Exchange& exchange);
  void set_money(const QuarterHourMoney& money) { money_ = money; }

  [[nodiscard]] bool is_empty() const { return cycles_ == 0; }
  [[nodiscard]] std::int32_t local_day() const { return local_day_; }
  [[nodiscard]] double earned_eur() const { return money_.earned_eur; }
  [[nodiscard]] double charged_kwh() const { return charged_wh_ / 1'000; }
  [[nodiscard]] double discharged_kwh() const { return discharged_wh_ / 1'000; }
  /// Of both together: while nobody looked, by the state of charge alone.
  [[nodiscard]] double unseen_kwh() const { return unseen_wh_ / 1'000; }
  [[nodiscard]] const QuarterHourMoney& money() const { return money_; }
  [[nodiscard]] double full_cycles() const;
  [[nodiscard]] int cycles() const { return cycles_; }
  /// In which the battery followed an order, 0 W included.
  [[nodiscard]] int driven_cycles() const { return driven_cycles_; }
  /// Of `cycles`, with a measurement and a price.
  [[nodiscard]] int valued_cycles() const { return valued_cycles_; }
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
  double charged_wh_ = 0;
  double discharged_wh_ = 0;
  double unseen_wh_ = 0;
  QuarterHourMoney money_{};
  std::int32_t soc_moved_e4_ = 0;
  int cycles_ = 0;
  int driven_cycles_ = 0;
  int valued_cycles_ = 0;
  std::int64_t first_soc_utc_s_ = INT64_MAX;
  std::int64_t last_soc_utc_s_ = INT64_MIN;
  std::int32_t first_soc_e4_ = 0;
  std::int32_t last_soc_e4_ = 0;
  std::int32_t capacity_wh_ = 0;
  CyclesByReason cycles_by_reason_{};
};

}  // namespace bess
