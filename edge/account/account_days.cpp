#include "edge/account/account_days.h"

#include <cmath>

#include "edge/control/quarter_hour_energy.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

/// What flowed in one quarter-hour.
struct QuarterHour {
  double charged_wh = 0;
  double discharged_wh = 0;

  [[nodiscard]] double net_mwh() const { return (charged_wh - discharged_wh) / kWattsPerMegawatt; }
  [[nodiscard]] double contract_eur(const Contract& contract, double eur_per_mwh) const {
    return contract.costs_eur(charged_wh / kWattsPerMegawatt, eur_per_mwh) +
           contract.costs_eur(-discharged_wh / kWattsPerMegawatt, eur_per_mwh);
  }
};

QuarterHourMoney money_of(const QuarterHour& quarter, const std::optional<SettledQuarter>& price,
                          const Contract& contract) {
  QuarterHourMoney money{.quarter_hours = 1};
  if (!price) {
    money.unpriced = 1;
    return money;
  }
  money.published = price->state != PriceState::kIndicative ? 1 : 0;
  money.validated = price->state == PriceState::kValidated ? 1 : 0;
  money.prices_eur_per_mwh = price->eur_per_mwh;
  // Subtracted: a day without exchange has earned nothing, and not minus nothing.
  money.earned_eur = 0.0 - quarter.net_mwh() * price->eur_per_mwh;
  if (money.published == 0) money.estimated_eur = money.earned_eur;
  money.contract_eur = quarter.contract_eur(contract, price->eur_per_mwh);
  return money;
}

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

std::int32_t local_day_at(std::int64_t utc_s) { return local_day_of(local_minute_of(utc_s)); }

void for_each_record(const LogReader& log, std::int32_t first_day, std::int32_t last_day,
                     const std::function<void(std::int32_t, const CycleRecord&)>& visit) {
  CycleRecord record;
  for (std::uint64_t n = log.newest_number(); n >= log.oldest_number() && n > 0; --n) {
    if (!log.read(n, record)) continue;
    const std::int32_t day = local_day_at(record.utc_s);
    if (day < first_day) break;
    if (day <= last_day) visit(day, record);
  }
}

void for_each_record_around(const LogReader& log, std::int32_t first_day, std::int32_t last_day,
                            const std::function<void(const CycleRecord&)>& visit) {
  CycleRecord record;
  const std::uint64_t first = number_before(log, first_day);
  for (std::uint64_t n = first; n > 0 && n <= log.newest_number(); ++n) {
    if (!log.read(n, record)) continue;
    visit(record);
    if (record.has_measurement && local_day_at(record.utc_s) > last_day) break;
  }
}

void DayBook::add(const CycleRecord& as_logged) {
  CycleRecord record = as_logged;
  if (record.measurement.capacity_wh <= 0) record.measurement.capacity_wh = terms_.capacity_wh;
  const std::int32_t day = local_day_at(record.utc_s);
  if (holds(day)) days_.try_emplace(day, day).first->second.add(record);
  prices_.note(record);
  ExchangeSample sample;
  if (sample_of(record, sample)) samples_.push_back(sample);
}

std::vector<DayAccount> DayBook::accounts() const {
  std::map<std::int32_t, DayAccount> days = days_;
  std::map<std::int64_t, QuarterHour> quarters;  // by its start
  for_each_exchange(samples_, [&](const Exchange& exchange) {
    const auto utc_s = static_cast<std::int64_t>(exchange.from_utc_s);
    const std::int32_t day = local_day_at(utc_s);
    const bool is_nothing = !exchange.is_seen && exchange.energy_wh == 0;
    if (!holds(day) || is_nothing) return;
    days.try_emplace(day, day).first->second.add(exchange);
    QuarterHour& quarter = quarters[quarter_hour_of(utc_s) * kQuarterHourS];
    (exchange.energy_wh > 0 ? quarter.charged_wh : quarter.discharged_wh) +=
        std::fabs(exchange.energy_wh);
  });
  std::map<std::int32_t, QuarterHourMoney> money;
  for (const auto& [start_utc_s, quarter] : quarters) {
    money[local_day_at(start_utc_s)].add(
        money_of(quarter, prices_.find(start_utc_s), terms_.contract));
  }
  std::vector<DayAccount> accounts;
  for (auto& [day, account] : days) {
    account.set_money(money[day]);
    if (!account.is_empty()) accounts.push_back(account);
  }
  return accounts;
}

std::vector<DayAccount> accounts_of_days(const LogReader& log, std::int32_t first_day,
                                         std::int32_t last_day, const MoneyTerms& terms) {
  DayBook book(first_day, last_day, terms);
  for_each_record_around(log, first_day, last_day,
                         [&](const CycleRecord& record) { book.add(record); });
  return book.accounts();
}

}  // namespace bess
