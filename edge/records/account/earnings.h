// Earnings over days, as text, CSV and JSON. Each quarter-hour counts at its settled price, or, as
// an estimate, at its last indicative price. The change in stored energy is valued at the mean
// price, because a day that ends empty has sold energy that another day bought.
#pragma once

#include <string>
#include <vector>

#include "edge/records/account/day_account.h"
#include "shared/host/json.h"

namespace bess {

class Earnings {
 public:
  /// `days`: oldest first; may be empty.
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
