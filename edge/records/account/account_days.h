// The accounts of local days, from the decision log.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string_view>
#include <vector>

#include "edge/records/account/day_account.h"
#include "edge/records/account/settled_prices.h"
#include "edge/records/log/log_reader.h"
#include "shared/host/exchange.h"
#include "shared/host/exchanged_days.h"

namespace bess {

// Local days as a person asks for them: today, yesterday, week, month, last-month, 2026-11,
// 2026-11-23, 2026-11-01..2026-11-23.

/// Both ends belong to it; days as 20231126.
struct Period {
  std::int32_t first_day = 0;
  std::int32_t last_day = 0;
  friend constexpr bool operator==(const Period&, const Period&) = default;
};

/// A week begins on Monday; week and month end today. False when it is none of these, or ends
/// before it begins.
bool parse_period(std::string_view text, std::int32_t today, Period& period);

/// False of a record without a measurement.
bool sample_of(const CycleRecord& record, ExchangeSample& sample);

/// Records, one after the other, into the accounts of their days.
class DayBook {
 public:
  /// Of the days from `first_day` to `last_day`, as 20231126; a record of another day counts only
  /// for what flowed between.
  DayBook(std::int32_t first_day, std::int32_t last_day, const MoneyTerms& terms)
      : first_day_(first_day),
        last_day_(last_day),
        capacity_wh_(terms.capacity_wh),
        prices_(terms.settled.quarters()) {}

  /// The oldest first.
  void add(const CycleRecord& as_logged);
  /// The days that had a cycle, oldest first.
  [[nodiscard]] std::vector<DayAccount> accounts() const;

 private:
  std::int32_t first_day_;
  std::int32_t last_day_;
  std::int32_t capacity_wh_;
  QuarterPrices prices_;
  std::map<std::int32_t, DayAccount> days_;
  std::int64_t last_utc_s_ = INT64_MAX;  ///< of the newest cycle of these days
  std::vector<ExchangeSample> samples_;
};

/// The days from `first_day` to `last_day` of which the log has a cycle, oldest first.
std::vector<DayAccount> accounts_of_days(const LogReader& log, std::int32_t first_day,
                                         std::int32_t last_day, const MoneyTerms& terms);

}  // namespace bess
