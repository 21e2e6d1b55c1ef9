#include "edge/account/account_days.h"

#include "shared/host/exchanged_days.h"
#include "shared/local_day.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

/// The newest record that is older than `day`, or the oldest of all; 0: the log is empty.
std::uint64_t number_before(const LogReader& log, std::int32_t day) {
  CycleRecord record;
  std::uint64_t oldest = 0;
  for (std::uint64_t n = log.newest_number(); n >= log.oldest_number() && n > 0; --n) {
    if (!log.read(n, record)) continue;
    oldest = n;
    if (record.has_measurement && local_day_at(record.utc_s) < day) break;
  }
  return oldest;
}

}  // namespace

bool sample_of(const CycleRecord& record, ExchangeSample& sample) {
  if (!record.has_measurement) return false;
  sample = {.utc_s = record.utc_s,
            .power_w = record.measurement.power_w,
            .soc_e4 = record.measurement.soc_e4,
            .capacity_wh = record.measurement.capacity_wh,
            .order_w = record.ordered_power_w};
  sample.is_ordered =
      record.written && (record.mode == Mode::kRunning || record.mode == Mode::kHolding);
  if (sample.is_ordered && record.price.has_row) {
    sample.set_written(record.price.minute_utc_s, record.price_age_s);
  }
  return true;
}

void DayBook::add(const CycleRecord& as_logged) {
  CycleRecord record = as_logged;
  if (record.measurement.capacity_wh <= 0) record.measurement.capacity_wh = capacity_wh_;
  const std::int32_t day = local_day_at(record.utc_s);
  if (day >= first_day_ && day <= last_day_) {
    DayAccount& account = days_.try_emplace(day, day).first->second;
    account.add(record);
    if (record.mode != Mode::kStopping) {
      const std::int64_t apart_s = record.utc_s - last_utc_s_;
      if (apart_s > kSecondsPerStep) account.add_missing(apart_s / kSecondsPerStep - 1);
      last_utc_s_ = record.utc_s;
    }
  }
  if (record.price.has_row) {
    prices_.note(record.utc_s, record.price.minute_utc_s,
                 static_cast<double>(record.price.price_centi_eur_per_mwh) / kCentiPerEur);
  }
  ExchangeSample sample;
  if (sample_of(record, sample)) samples_.push_back(sample);
}

std::vector<DayAccount> DayBook::accounts() const {
  const auto exchanged = exchanged_days(samples_, prices_, BatteryParameters{});
  std::vector<DayAccount> accounts;
  for (const auto& [day, account] : days_) {
    if (account.is_empty()) continue;
    accounts.push_back(account);
    const auto found = exchanged.find(day);
    if (found != exchanged.end()) accounts.back().set_exchanged(found->second);
  }
  return accounts;
}

/// The last measured record before these days, and the first behind them, tell what flowed, and
/// what was paid, at both ends.
std::vector<DayAccount> accounts_of_days(const LogReader& log, std::int32_t first_day,
                                         std::int32_t last_day, const MoneyTerms& terms) {
  DayBook book(first_day, last_day, terms);
  CycleRecord record;
  const std::uint64_t first = number_before(log, first_day);
  for (std::uint64_t n = first; n > 0 && n <= log.newest_number(); ++n) {
    if (!log.read(n, record)) continue;
    book.add(record);
    if (record.has_measurement && local_day_at(record.utc_s) > last_day) break;
  }
  return book.accounts();
}

}  // namespace bess
