#include "workstation/run/run_fold.h"

#include <algorithm>

#include "shared/host/user_error.h"
#include "workstation/backtest/walk_forward.h"

namespace bess {

std::vector<std::string> fold_months(const MarketSteps& market) {
  std::vector<std::string> months;
  for (const Fold& fold : make_folds(market, kFoldWindowDays).traded) months.push_back(fold.month);
  return months;
}

MarketSteps market_of_fold(const MarketSteps& market, const std::string& month) {
  Folds folds = make_folds(market, kFoldWindowDays);
  const auto found = std::ranges::find(folds.traded, month, &Fold::month);
  if (found == folds.traded.end()) {
    fail("fold {}: these prices have no such month with half of {} days before it", month,
         kFoldWindowDays);
  }
  return std::move(found->market);
}

std::vector<MarketDay> fitted_days(const MarketSteps& fold) {
  std::vector<MarketDay> days = fold.days;
  std::erase_if(days, [](const MarketDay& day) { return day.split == Split::kTest; });
  return days;
}

}  // namespace bess
