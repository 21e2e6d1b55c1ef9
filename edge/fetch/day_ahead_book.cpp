#include "edge/fetch/day_ahead_book.h"

#include <algorithm>

#include "shared/local_time.h"

namespace bess {
namespace {

constexpr int kDays = 3;               ///< yesterday, today, tomorrow
constexpr int kDisagreeingShare = 10;  ///< one in this many
constexpr int kPublicationHour = 13;
constexpr std::int64_t kLongestStepS = 3'600;

std::int64_t begin_of(const OutlookDays& days, int day) {
  const std::int64_t midnights[] = {days.yesterday_utc_s, days.today_utc_s, days.tomorrow_utc_s,
                                    days.end_utc_s};
  return midnights[day];
}

/// `take(time of a quarter-hour, its price in `days`)`, of one of the days.
template <typename Take>
void for_each_quarter_hour(const OutlookDays& days, int day, const Take& take) {
  const std::int64_t end = begin_of(days, day + 1);
  for (std::int64_t t = begin_of(days, day); t < end; t += kSecondsPerQuarterHour) {
    take(t, days.day_ahead_centi[days.index_of(t)]);
  }
}

/// The step from row to row, a quarter of an hour to an hour; 0 where there is none.
std::int64_t step_of(std::span<const TimedPrice> rows) {
  std::int64_t step_s = rows.size() == 1 ? kSecondsPerQuarterHour : kLongestStepS;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].utc_s <= 0 || rows[i].utc_s % kSecondsPerQuarterHour != 0) return 0;
    if (i == 0) continue;
    const std::int64_t rise_s = rows[i].utc_s - rows[i - 1].utc_s;
    // Twice the same is once; twice otherwise, nobody knows which is meant.
    const bool is_again = rise_s == 0 && rows[i].centi_eur_per_mwh == rows[i - 1].centi_eur_per_mwh;
    if (rise_s < 0 || (rise_s == 0 && !is_again)) return 0;
    if (rise_s > 0) step_s = std::min(step_s, rise_s);
  }
  return step_s;
}

/// What an answer says of the days around now; false where it says nothing of them.
bool lay_out(std::span<const TimedPrice> rows, std::int64_t step_s, OutlookDays& days) {
  bool is_any = false;
  for (const TimedPrice& row : rows) {
    for (std::int64_t t = row.utc_s; t < row.utc_s + step_s; t += kSecondsPerQuarterHour) {
      if (t < days.yesterday_utc_s || t >= days.end_utc_s) continue;
      days.day_ahead_centi[days.index_of(t)] = row.centi_eur_per_mwh;
      is_any = true;
    }
  }
  return is_any;
}

std::size_t place_of(std::int64_t utc_s) {
  return static_cast<std::size_t>(utc_s / kSecondsPerQuarterHour % DayAheadBook::kPricesMax);
}

}  // namespace

std::int64_t publication_utc_s(std::int64_t today_midnight_utc_s) {
  const LocalMinute day = local_minute_of(today_midnight_utc_s);
  return utc_from_local({day.year, day.month, day.day, kPublicationHour, 0, 0});
}

/// What came later than now came by a clock that was wrong: nothing is known of it.
const KnownPrice* DayAheadBook::find(std::int64_t utc_s, std::int64_t now_utc_s) const {
  const KnownPrice& price = prices_[place_of(utc_s)];
  return price.utc_s == utc_s && price.received_utc_s <= now_utc_s ? &price : nullptr;
}

bool DayAheadBook::has_all(std::int64_t from_utc_s, std::int64_t until_utc_s,
                           std::int64_t now_utc_s) const {
  for (std::int64_t t = from_utc_s; t < until_utc_s; t += kSecondsPerQuarterHour) {
    if (find(t, now_utc_s) == nullptr) return false;
  }
  return true;
}

bool DayAheadBook::disagrees(const OutlookDays& answer, std::int64_t now_utc_s) const {
  int shared = 0;
  int different = 0;
  for (int day = 0; day < kDays; ++day) {
    if (!has_all(begin_of(answer, day), begin_of(answer, day + 1), now_utc_s)) continue;
    for_each_quarter_hour(answer, day, [&](std::int64_t t, std::int32_t centi) {
      if (centi == kDayAheadUnknown) return;
      ++shared;
      different += find(t, now_utc_s)->centi_eur_per_mwh != centi ? 1 : 0;
    });
  }
  return different * kDisagreeingShare > shared;
}

/// Of days of one length alone; a day of one price all through may well come twice.
bool DayAheadBook::repeats_day_before(const OutlookDays& answer, int day,
                                      std::int64_t now_utc_s) const {
  const std::int64_t before = begin_of(answer, day - 1);
  const std::int64_t begin = begin_of(answer, day);
  if (begin_of(answer, day + 1) - begin != begin - before) return false;
  bool is_same = true;
  bool moves = false;
  std::int32_t first = kDayAheadUnknown;
  for_each_quarter_hour(answer, day, [&](std::int64_t t, std::int32_t centi) {
    const std::int64_t t_before = t - (begin - before);
    const KnownPrice* const kept = find(t_before, now_utc_s);
    const std::int32_t centi_before = kept != nullptr
                                          ? kept->centi_eur_per_mwh
                                          : answer.day_ahead_centi[answer.index_of(t_before)];
    is_same = is_same && centi != kDayAheadUnknown && centi == centi_before;
    if (first == kDayAheadUnknown) first = centi;
    moves = moves || centi != first;
  });
  return is_same && moves;
}

/// Of a whole day what came first stays.
void DayAheadBook::keep_day(const OutlookDays& answer, int day, std::int64_t now_utc_s) {
  if (has_all(begin_of(answer, day), begin_of(answer, day + 1), now_utc_s)) return;
  for_each_quarter_hour(answer, day, [&](std::int64_t t, std::int32_t centi) {
    if (centi == kDayAheadUnknown) return;
    const KnownPrice* const kept = find(t, now_utc_s);
    if (kept != nullptr && kept->centi_eur_per_mwh == centi) return;
    prices_[place_of(t)] = {.utc_s = t, .received_utc_s = now_utc_s, .centi_eur_per_mwh = centi};
    ++changes_;
  });
}

Status DayAheadBook::take(std::span<const TimedPrice> rows, std::int64_t now_utc_s) {
  if (rows.empty()) return Status::kNoRow;
  const std::int64_t step_s = step_of(rows);
  if (step_s == 0) return Status::kMalformed;
  OutlookDays answer = outlook_days_around(now_utc_s);
  if (!lay_out(rows, step_s, answer)) return Status::kNoRow;
  if (disagrees(answer, now_utc_s)) return Status::kImplausible;
  Status status = Status::kOk;
  for (int day = 0; day < kDays; ++day) {
    if (day > 0 && repeats_day_before(answer, day, now_utc_s)) {
      status = Status::kImplausible;
    } else {
      keep_day(answer, day, now_utc_s);
    }
  }
  return status;
}

bool DayAheadBook::restore(const KnownPrice& price) {
  constexpr std::int32_t kMaxCenti = kPlausiblePriceMaxCentiEurPerMwh;
  const bool is_possible = price.utc_s > 0 && price.utc_s % kSecondsPerQuarterHour == 0 &&
                           price.received_utc_s > 0 && price.centi_eur_per_mwh >= -kMaxCenti &&
                           price.centi_eur_per_mwh <= kMaxCenti;
  if (is_possible) prices_[place_of(price.utc_s)] = price;
  return is_possible;
}

OutlookDays DayAheadBook::days_at(std::int64_t utc_s) const {
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
