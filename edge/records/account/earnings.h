// What a battery earned in some days, as a table for people, as CSV and as JSON.
//
// Money is counted by quarter-hours: at the settled price where it is published, else, an estimate,
// at the last indicative one. And what the battery holds more or less at the end than at the
// beginning, at the mean price: a day that ends empty has sold what another one bought.
#pragma once

#include <string>
#include <vector>

#include "edge/records/account/day_account.h"
#include "shared/host/json.h"

namespace bess {

class Earnings {
 public:
  /// Oldest first; may be empty.
  explicit Earnings(std::vector<DayAccount> days);

  [[nodiscard]] const std::vector<DayAccount>& days() const { return days_; }
  [[nodiscard]] const DayAccount& together() const { return together_; }

  [[nodiscard]] std::string text() const;
  [[nodiscard]] std::string csv() const;
  [[nodiscard]] Json json() const;

 private:
  std::vector<DayAccount> days_;
  DayAccount together_{0};
};

}  // namespace bess
