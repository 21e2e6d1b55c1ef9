// Which days a figure is about, and whether what is judged had learnt from later ones: days 26 to
// the end of each month are kept from learning, but the months after them are not.
#pragma once

#include <string>
#include <vector>

#include "shared/host/json.h"
#include "workstation/env/market_steps.h"

namespace bess {

struct JudgedDays {
  Split split;
  std::vector<std::string> dates;  ///< of the days, ascending, "2023-01-31"
  std::string last_learnt;         ///< the last day that was trained or chosen on; empty: not known

  [[nodiscard]] std::size_t before_last_learnt() const;  ///< how many of the days are
  [[nodiscard]] std::size_t months() const;
};

/// The last training or validation day; empty without any.
std::string last_learnt_day(const MarketSteps& market);

JudgedDays judged_days(const MarketSteps& market, Split split);

/// Two sentences for people: the rule of the split with the days' span, and what learning saw.
std::string judged_days_text(const JudgedDays& judged);
Json judged_days_json(const JudgedDays& judged);

}  // namespace bess
