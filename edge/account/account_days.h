// The accounts of local days, from the decision log.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "edge/account/day_account.h"
#include "edge/account/exchange.h"
#include "edge/account/money_settings.h"
#include "edge/account/quarter_prices.h"
#include "edge/log/log_reader.h"

namespace bess {

/// As 20231126.
std::int32_t local_day_at(std::int64_t utc_s);

/// The records of those local days, both ends included, the newest first.
void for_each_record(const LogReader& log, std::int32_t first_day, std::int32_t last_day,
                     const std::function<void(std::int32_t day, const CycleRecord&)>& visit);

/// The oldest first; besides the last measured one before them, and the first behind them, which
/// tell what flowed, and what was paid, at both ends.
void for_each_record_around(const LogReader& log, std::int32_t first_day, std::int32_t last_day,
                            const std::function<void(const CycleRecord&)>& visit);

/// Records, one after the other, into the accounts of their days.
class DayBook {
 public:
  /// Of the days from `first_day` to `last_day`, as 20231126; a record of another day counts only
  /// for what flowed between.
  DayBook(std::int32_t first_day, std::int32_t last_day, const MoneyTerms& terms)
      : first_day_(first_day), last_day_(last_day), terms_(terms), prices_(terms.settled) {}

  /// The oldest first.
  void add(const CycleRecord& as_logged);
  /// The days that had a cycle, oldest first.
  [[nodiscard]] std::vector<DayAccount> accounts() const;

 private:
  [[nodiscard]] bool holds(std::int32_t day) const { return day >= first_day_ && day <= last_day_; }

  std::int32_t first_day_;
  std::int32_t last_day_;
  const MoneyTerms& terms_;
  QuarterPrices prices_;
  std::map<std::int32_t, DayAccount> days_;
  std::vector<ExchangeSample> samples_;
};

/// The days from `first_day` to `last_day` of which the log has a cycle, oldest first.
std::vector<DayAccount> accounts_of_days(const LogReader& log, std::int32_t first_day,
                                         std::int32_t last_day, const MoneyTerms& terms);

}  // namespace bess
