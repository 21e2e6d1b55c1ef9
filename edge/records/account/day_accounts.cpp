#include "edge/records/account/day_accounts.h"

#include <chrono>
#include <string>
#include <utility>

#include "shared/host/exchange.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {

namespace {

using Days = std::chrono::sys_days;

Days days_of(std::int32_t day) {
  using namespace std::chrono;
  return year{day / 10'000} / month{static_cast<unsigned>(day / 100 % 100)} /
         std::chrono::day{static_cast<unsigned>(day % 100)};
}

std::int32_t day_of(Days days) {
  const std::chrono::year_month_day date{days};
  return static_cast<int>(date.year()) * 10'000 +
         static_cast<int>(static_cast<unsigned>(date.month())) * 100 +
         static_cast<int>(static_cast<unsigned>(date.day()));
}

/// First to last day of the month.
Period month_of(std::int32_t day) {
  using namespace std::chrono;
  const year_month month =
      year{day / 10'000} / std::chrono::month{static_cast<unsigned>(day / 100 % 100)};
  return {day / 100 * 100 + 1, day_of(Days{month / last})};
}

/// "2026-11-23" and nothing else.
bool parse_date(std::string_view text, std::int32_t& day) {
  CivilTime date{};
  if (!detail::take_date(text, date) || !text.empty()) return false;
  day = date.year * 10'000 + date.month * 100 + date.day;
  return true;
}

/// "2026-11" and nothing else.
bool parse_month(std::string_view text, Period& period) {
  std::int32_t first_day = 0;
  if (text.size() != 7 || !parse_date(std::string(text) + "-01", first_day)) return false;
  period = month_of(first_day);
  return true;
}

}  // namespace

bool parse_period(std::string_view text, std::int32_t today, Period& period) {
  using std::chrono::days;
  const Days now = days_of(today);
  const std::int32_t yesterday = day_of(now - days{1});
  const days since_monday = std::chrono::weekday{now} - std::chrono::Monday;
  const std::int32_t first_of_month = today / 100 * 100 + 1;
  const std::pair<std::string_view, Period> named_periods[] = {
      {"today", {today, today}},
      {"yesterday", {yesterday, yesterday}},
      {"week", {day_of(now - since_monday), today}},
      {"month", {first_of_month, today}},
      {"last-month", month_of(day_of(days_of(first_of_month) - days{1}))}};
  for (const auto& [name, named] : named_periods) {
    if (text != name) continue;
    period = named;
    return true;
  }
  if (parse_month(text, period)) return true;
  const std::size_t dots = text.find("..");
  const std::string_view first = text.substr(0, dots);
  const std::string_view last = dots == text.npos ? first : text.substr(dots + 2);
  return parse_date(first, period.first_day) && parse_date(last, period.last_day) &&
         period.first_day <= period.last_day;
}

namespace {

/// Newest record before `day`, or the oldest of all; 0 = empty log.
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

void DayAccounts::add(const CycleRecord& as_logged) {
  CycleRecord record = as_logged;
  if (record.measurement.capacity_wh <= 0) record.measurement.capacity_wh = capacity_wh_;
  const std::int32_t day = local_day_at(record.utc_s);
  if (day < first_day_) last_utc_s_ = local_day_start_utc_s(first_day_) - kSecondsPerStep;
  if (day >= first_day_ && day <= last_day_) {
    DayAccount& account = days_.try_emplace(day, DayAccount{.local_day = day}).first->second;
    account.add(record);
    if (record.mode != Mode::kStopping) {
      const std::int64_t apart_s = record.utc_s - last_utc_s_;
      if (apart_s > kSecondsPerStep) {
        account.missing_cycles += static_cast<int>(apart_s / kSecondsPerStep - 1);
      }
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

std::vector<DayAccount> DayAccounts::accounts() const {
  const auto exchanged = exchanged_days(samples_, prices_, BatteryParameters{});
  std::vector<DayAccount> accounts;
  for (const auto& [day, account] : days_) {
    if (account.cycles == 0) continue;
    accounts.push_back(account);
    const auto found = exchanged.find(day);
    if (found != exchanged.end()) accounts.back().exchanged = found->second;
  }
  return accounts;
}

/// Includes the last measured record before these days and the first after them, for the energy at
/// both ends.
std::vector<DayAccount> accounts_of_days(const LogReader& log, std::int32_t first_day,
                                         std::int32_t last_day, const MoneyTerms& terms) {
  DayAccounts day_accounts(first_day, last_day, terms);
  CycleRecord record;
  const std::uint64_t first = number_before(log, first_day);
  for (std::uint64_t n = first; n > 0 && n <= log.newest_number(); ++n) {
    if (!log.read(n, record)) continue;
    day_accounts.add(record);
    if (record.has_measurement && local_day_at(record.utc_s) > last_day) break;
  }
  return day_accounts.accounts();
}

}  // namespace bess
