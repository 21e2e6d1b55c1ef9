#include "edge/prices/fetch/day_ahead_feed.h"

#include <algorithm>
#include <cmath>

#include "shared/local_time.h"

namespace bess {
namespace {

constexpr int kDays = 3;               ///< yesterday, today, tomorrow
constexpr int kDisagreeingShare = 10;  ///< one in this many
constexpr int kPublicationHour = 13;
constexpr std::int64_t kBelievedAfterS = 3 * 3'600;  ///< an unchanged assumed price

std::int64_t begin_of(const OutlookDays& days, int day) {
  const std::int64_t midnights[] = {days.yesterday_utc_s, days.today_utc_s, days.tomorrow_utc_s,
                                    days.end_utc_s};
  return midnights[day];
}

/// Calls `take(time of a quarter-hour, its price in `days`)` for one of the days.
template <typename Take>
void for_each_quarter_hour(const OutlookDays& days, int day, const Take& take) {
  const std::int64_t end = begin_of(days, day + 1);
  for (std::int64_t t = begin_of(days, day); t < end; t += kSecondsPerQuarterHour) {
    take(t, days.day_ahead_centi[days.index_of(t)]);
  }
}

/// Prices as in EUR/kWh: no auction day stays within this.
bool is_in_another_unit(const DayAheadDay& day) {
  constexpr double kNoDayStaysWithinEur = 5;
  constexpr std::size_t kDayOfPrices = 92;
  return day.quarter_hours.size() >= kDayOfPrices &&
         std::ranges::all_of(day.quarter_hours, [](const DayAheadQuarterHour& q) {
           return std::fabs(q.eur_per_mwh) < kNoDayStaysWithinEur;
         });
}

std::size_t place_of(std::int64_t utc_s) {
  return static_cast<std::size_t>(utc_s / kSecondsPerQuarterHour % DayAheadStore::kPricesMax);
}

}  // namespace

std::int64_t publication_utc_s(std::int64_t today_midnight_utc_s) {
  const LocalMinute day = local_minute_of(today_midnight_utc_s);
  return utc_from_local({day.year, day.month, day.day, kPublicationHour, 0, 0});
}

/// A receipt time in the future means a wrong clock: unknown.
const KnownPrice* DayAheadStore::find(std::int64_t utc_s, std::int64_t now_utc_s) const {
  const KnownPrice& price = prices_[place_of(utc_s)];
  return price.utc_s == utc_s && price.received_utc_s <= now_utc_s ? &price : nullptr;
}

bool DayAheadStore::has_all(std::int64_t from_utc_s, std::int64_t until_utc_s,
                            std::int64_t now_utc_s) const {
  for (std::int64_t t = from_utc_s; t < until_utc_s; t += kSecondsPerQuarterHour) {
    const KnownPrice* const known = find(t, now_utc_s);
    if (known == nullptr || known->is_assumed) return false;
  }
  return true;
}

bool DayAheadStore::disagrees(const Answer& answer, std::int64_t now_utc_s) const {
  int shared = 0;
  int different = 0;
  for (int day = 0; day < kDays; ++day) {
    if (!has_all(begin_of(answer, day), begin_of(answer, day + 1), now_utc_s)) continue;
    for_each_quarter_hour(answer, day, [&](std::int64_t t, std::int32_t centi) {
      if (centi == kDayAheadUnknown || answer.is_assumed[answer.index_of(t)]) return;
      ++shared;
      different += find(t, now_utc_s)->centi_eur_per_mwh != centi ? 1 : 0;
    });
  }
  return different * kDisagreeingShare > shared;
}

/// A server that repeats what contradicts the stored prices for three hours has corrected them.
bool DayAheadStore::is_repeated(const Answer& answer, std::int64_t now_utc_s) {
  if (!refused_ || !(*refused_ == answer)) {
    refused_ = answer;
    refused_utc_s_ = now_utc_s;
  }
  return now_utc_s >= refused_utc_s_ + kBelievedAfterS;
}

/// Of the days that the answer has.
void DayAheadStore::forget(const Answer& answer) {
  for (int day = 0; day < kDays; ++day) {
    for_each_quarter_hour(answer, day, [&](std::int64_t t, std::int32_t centi) {
      if (centi != kDayAheadUnknown) prices_[place_of(t)] = {};
    });
  }
}

/// Compares only days of equal length.
bool DayAheadStore::repeats_day_before(const OutlookDays& answer, int day,
                                       std::int64_t now_utc_s) const {
  const std::int64_t before = begin_of(answer, day - 1);
  const std::int64_t begin = begin_of(answer, day);
  if (begin_of(answer, day + 1) - begin != begin - before) return false;
  bool is_same = true;
  for_each_quarter_hour(answer, day, [&](std::int64_t t, std::int32_t centi) {
    const std::int64_t t_before = t - (begin - before);
    const KnownPrice* const kept = find(t_before, now_utc_s);
    const std::int32_t centi_before = kept != nullptr
                                          ? kept->centi_eur_per_mwh
                                          : answer.day_ahead_centi[answer.index_of(t_before)];
    is_same = is_same && centi != kDayAheadUnknown && centi == centi_before;
  });
  return is_same;
}

/// The first complete version of a day is kept.
void DayAheadStore::keep_day(const Answer& answer, int day, std::int64_t now_utc_s) {
  if (has_all(begin_of(answer, day), begin_of(answer, day + 1), now_utc_s)) return;
  for_each_quarter_hour(answer, day, [&](std::int64_t t, std::int32_t centi) {
    if (centi == kDayAheadUnknown) return;
    const bool is_assumed = answer.is_assumed[answer.index_of(t)];
    const KnownPrice* const kept = find(t, now_utc_s);
    if (kept == nullptr || kept->centi_eur_per_mwh != centi) {
      prices_[place_of(t)] = {.utc_s = t,
                              .received_utc_s = now_utc_s,
                              .centi_eur_per_mwh = centi,
                              .is_assumed = is_assumed};
      ++changes_;
    } else if (kept->is_assumed &&
               (!is_assumed || now_utc_s >= kept->received_utc_s + kBelievedAfterS)) {
      prices_[place_of(t)].is_assumed = false;
      ++changes_;
    }
  });
}

Status DayAheadStore::take(std::span<const DayAheadDay> days, std::int64_t now_utc_s) {
  Answer answer{outlook_days_around(now_utc_s)};
  Status status = Status::kNoRow;
  bool is_refused = false;
  bool has_other_unit = false;
  for (const DayAheadDay& day : days) {
    const bool is_constant = day.is_constant();
    if (!is_constant && is_in_another_unit(day)) {
      has_other_unit = true;
      continue;
    }
    for (const DayAheadQuarterHour& q : day.quarter_hours) {
      if (q.utc_s < answer.yesterday_utc_s || q.utc_s >= answer.end_utc_s) continue;
      is_refused = is_refused || is_constant;
      const bool is_price = std::fabs(q.eur_per_mwh) <= kPlausiblePriceMaxEurPerMwh &&
                            !is_day_ahead_sentinel(q.eur_per_mwh);
      if (is_constant || !is_price) continue;
      answer.day_ahead_centi[answer.index_of(q.utc_s)] =
          static_cast<std::int32_t>(std::lround(q.eur_per_mwh * kCentiPerEur));
      answer.is_assumed[answer.index_of(q.utc_s)] = q.is_assumed;
      status = Status::kOk;
    }
  }
  if (disagrees(answer, now_utc_s)) {
    if (!is_repeated(answer, now_utc_s)) return Status::kImplausible;
    forget(answer);
  }
  refused_.reset();
  for (int day = 0; day < kDays; ++day) {
    if (day > 0 && repeats_day_before(answer, day, now_utc_s)) {
      is_refused = true;
    } else {
      keep_day(answer, day, now_utc_s);
    }
  }
  if (has_other_unit) return Status::kDoubtfulUnit;
  return is_refused ? Status::kImplausible : status;
}

bool DayAheadStore::restore(const KnownPrice& price) {
  constexpr std::int32_t kMaxCenti = kPlausiblePriceMaxCentiEurPerMwh;
  const bool is_possible = price.utc_s > 0 && price.utc_s % kSecondsPerQuarterHour == 0 &&
                           price.received_utc_s > 0 && price.centi_eur_per_mwh >= -kMaxCenti &&
                           price.centi_eur_per_mwh <= kMaxCenti;
  if (is_possible) prices_[place_of(price.utc_s)] = price;
  return is_possible;
}

OutlookDays DayAheadStore::days_at(std::int64_t utc_s) const {
  OutlookDays days = outlook_days_around(utc_s);
  const bool is_published = utc_s >= publication_utc_s(days.today_utc_s);
  for (int day = 0; day < (is_published ? kDays : kDays - 1); ++day) {
    for_each_quarter_hour(days, day, [&](std::int64_t t, std::int32_t) {
      const KnownPrice* const known = find(t, utc_s);
      if (known != nullptr) days.day_ahead_centi[days.index_of(t)] = known->centi_eur_per_mwh;
    });
  }
  return days;
}

}  // namespace bess
