#include "edge/records/account/day_accounts.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <string>
#include <utility>

#include "shared/host/text.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {

void DayAccount::add(const CycleRecord& record) {
  if (record.mode == Mode::kStopping) return;  // no control cycle
  const auto reason = static_cast<std::size_t>(record.reason);
  const bool is_driven = record.mode == Mode::kRunning && record.written;
  ++cycles;
  ++cycles_by_reason[reason];
  if (is_driven) ++driven_cycles;
  if (!is_driven) ++not_driven_by_reason[reason];
  if (record.throughput.local_day == local_day) {
    soc_moved_e4 = std::max(soc_moved_e4, record.throughput.soc_moved_e4);
  }
  if (!record.has_measurement) return;
  const Charge now{record.utc_s, record.measurement.soc_e4};
  if (now.utc_s < first.utc_s) first = now;
  if (now.utc_s >= last.utc_s) {
    last = now;
    capacity_wh = record.measurement.capacity_wh;
  }
  if (record.price.has_row) ++valued_cycles;
}

void DayAccount::add(const DayAccount& other) {
  exchanged.add(other.exchanged);
  soc_moved_e4 += other.soc_moved_e4;
  cycles += other.cycles;
  missing_cycles += other.missing_cycles;
  driven_cycles += other.driven_cycles;
  valued_cycles += other.valued_cycles;
  if (other.first.utc_s < first.utc_s) first = other.first;
  if (other.last.utc_s > last.utc_s) {
    last = other.last;
    capacity_wh = other.capacity_wh;
  }
  for (std::size_t i = 0; i < cycles_by_reason.size(); ++i) {
    cycles_by_reason[i] += other.cycles_by_reason[i];
    not_driven_by_reason[i] += other.not_driven_by_reason[i];
  }
}

double DayAccount::full_cycles() const { return soc_moved_e4 / (2.0 * kSocFullE4); }

double DayAccount::driven_share() const {
  const int all = cycles + missing_cycles;
  return all == 0 ? 0 : static_cast<double>(driven_cycles) / all;
}

double DayAccount::first_soc_percent() const {
  return has_soc() ? first.soc_e4 / 100.0 : std::numeric_limits<double>::quiet_NaN();
}

double DayAccount::last_soc_percent() const {
  return has_soc() ? last.soc_e4 / 100.0 : std::numeric_limits<double>::quiet_NaN();
}

double DayAccount::stored_kwh() const {
  if (!has_soc()) return 0;
  return static_cast<double>(last.soc_e4 - first.soc_e4) / kSocFullE4 * capacity_wh / 1'000;
}

double DayAccount::stored_eur() const {
  const BatteryParameters battery;
  const double grid_mwh =
      stored_kwh() / 1'000 *
      (stored_kwh() > 0 ? battery.discharge_efficiency : 1 / battery.charge_efficiency);
  return grid_mwh * exchanged.money.mean_price_eur_per_mwh();
}

int DayAccount::interventions() const {
  return cycles - cycles_by_reason[static_cast<std::size_t>(Reason::kStudent)];
}

std::int64_t local_day_start_utc_s(std::int32_t local_day) {
  return utc_from_local({local_day / 10'000, local_day / 100 % 100, local_day % 100, 0, 0, 0});
}

std::string local_day_text(std::int32_t local_day) {
  return formatted("%04d-%02d-%02d", local_day / 10'000 % 10'000, local_day / 100 % 100,
                   local_day % 100);
}

std::string DayAccount::interventions_text() const {
  std::string text;
  for (std::size_t i = 0; i < cycles_by_reason.size(); ++i) {
    const auto reason = static_cast<Reason>(i);
    if (cycles_by_reason[i] == 0 || reason == Reason::kStudent) continue;
    add_formatted(text, "%s%s %d", text.empty() ? "" : ", ", reason_name(reason).data(),
                  cycles_by_reason[i]);
  }
  return text;
}

std::string DayAccount::line() const {
  std::string line = formatted(
      "%s: %+.2f EUR (%d of %d quarter-hours at the settled price, an estimate in the others), "
      "charged %.1f kWh, discharged %.1f kWh, %.2f full cycles, %d interventions",
      local_day_text(local_day).c_str(), exchanged.money.earned_eur, exchanged.money.published,
      exchanged.money.quarter_hours, charged_kwh(), discharged_kwh(), full_cycles(),
      interventions());
  if (interventions() > 0) line += " (" + interventions_text() + ")";
  return line;
}

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
