#include "workstation/run/run_fold.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "shared/host/user_error.h"
#include "workstation/backtest/walk_forward.h"

namespace bess {

namespace {

MarketSteps market_of_days(const MarketSteps& market, const FoldDays& days) {
  auto made = make_fold(market, days.name(), days.first, days.last, {days.window_days});
  if (const auto* skipped = std::get_if<SkippedMonth>(&made)) {
    fail("fold {}: {}; give more prices or another window", skipped->month, skipped->reason);
  }
  return std::move(std::get<Fold>(made).market);
}

}  // namespace

std::string FoldDays::name() const {
  return fmt::format("{} to {}, {} days before", format_local_date(first), format_local_date(last),
                     window_days);
}

std::optional<FoldDays> parse_fold_days(const std::string& name) {
  if (name.find(" to ") != 10 || name.find(", ") != 24) return std::nullopt;
  return FoldDays{parse_local_date(name.substr(0, 10), "fold"),
                  parse_local_date(name.substr(14, 10), "fold"),
                  static_cast<int>(std::strtol(name.c_str() + 26, nullptr, 10))};
}

std::vector<std::string> fold_months(const MarketSteps& market) {
  std::vector<std::string> months;
  for (const Fold& fold : make_folds(market, {kFoldWindowDays}).traded)
    months.push_back(fold.month);
  return months;
}

MarketSteps market_of_fold(const MarketSteps& market, const std::string& month) {
  if (const auto days = parse_fold_days(month)) return market_of_days(market, *days);
  Folds folds = make_folds(market, {kFoldWindowDays});
  const auto found = std::ranges::find(folds.traded, month, &Fold::month);
  if (found == folds.traded.end()) {
    fail("fold {}: these prices have no such month with half of {} days before it", month,
         kFoldWindowDays);
  }
  return std::move(found->market);
}

}  // namespace bess
