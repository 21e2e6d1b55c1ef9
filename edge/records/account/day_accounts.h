// Accounts of local days, from the decision log, and their earnings as text, CSV and JSON. Each
// quarter-hour counts at its settled price, or, as an estimate, at its last indicative price. The
// change in stored energy is valued at the mean price, because a day that ends empty has sold energy
// that another day bought.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "edge/records/account/day_account.h"
#include "edge/records/account/settled_prices.h"
#include "edge/records/log/log_reader.h"
#include "shared/host/exchange.h"
#include "shared/host/json.h"

namespace bess {

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
