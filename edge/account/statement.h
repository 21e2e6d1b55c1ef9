// What a battery earned in some days, as a table for people, as CSV and as JSON.
//
// Money is counted by quarter-hours: at the settled price where it is published, else, an estimate,
// at the last indicative one. Then what the contract takes; and what the battery holds more or less
// at the end than at the beginning, at the mean price: a day that ends empty has sold what another
// one bought.
#pragma once

#include <string>
#include <vector>

#include "edge/account/contract.h"
#include "edge/account/day_account.h"
#include "shared/host/json.h"

namespace bess {

class Statement {
 public:
  /// Oldest first, without gaps in what each counts; may be empty.
  explicit Statement(std::vector<DayAccount> days, const Contract& contract = {})
      : days_(std::move(days)), contract_(contract) {}

  [[nodiscard]] bool is_empty() const { return days_.empty(); }
  [[nodiscard]] double earned_eur() const;
  [[nodiscard]] double charged_kwh() const;
  [[nodiscard]] double discharged_kwh() const;
  [[nodiscard]] double unseen_kwh() const;
  [[nodiscard]] QuarterHourMoney money() const;
  /// More (negative: less) is stored at the end than at the beginning.
  [[nodiscard]] double stored_kwh() const;
  /// Less what the contract takes.
  [[nodiscard]] double earned_at_equal_soc_eur() const { return money().net_eur() + stored_eur(); }
  /// The same of one of the days, at the mean price of all.
  [[nodiscard]] double day_at_equal_soc_eur(const DayAccount& day) const;
  /// As it was first measured; false: never.
  [[nodiscard]] bool has_soc() const { return first_measured() != nullptr; }
  [[nodiscard]] double first_soc_frac() const;
  /// Of the newest day that it was measured on.
  [[nodiscard]] double capacity_wh() const;
  /// Of the quarter-hours of all days.
  [[nodiscard]] double mean_price_eur_per_mwh() const { return money().mean_price_eur_per_mwh(); }
  /// With losses and the contract, as if it was sold at once, or bought (drive.h).
  [[nodiscard]] double stored_eur() const;

  [[nodiscard]] const std::vector<DayAccount>& days() const { return days_; }
  [[nodiscard]] const Contract& contract() const { return contract_; }

  [[nodiscard]] std::string text() const;
  [[nodiscard]] std::string csv() const;
  [[nodiscard]] Json json() const;

 private:
  template <typename OfDay>
  [[nodiscard]] double sum(const OfDay& of_day) const;
  [[nodiscard]] CyclesByReason cycles_by_reason() const;
  /// Null: none.
  [[nodiscard]] const DayAccount* first_measured() const;
  [[nodiscard]] const DayAccount* last_measured() const;

  [[nodiscard]] std::int32_t stored_e4() const;
  [[nodiscard]] double worth_eur(std::int32_t more_e4) const;
  [[nodiscard]] std::string money_text() const;

  std::vector<DayAccount> days_;
  Contract contract_;
};

}  // namespace bess
