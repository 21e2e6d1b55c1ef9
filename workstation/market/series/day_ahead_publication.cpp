#include "workstation/market/series/day_ahead_publication.h"

#include <algorithm>
#include <limits>

#include "shared/local_time.h"
#include "workstation/market/series/local_date.h"

namespace bess {
namespace {

constexpr std::int64_t kNever_s = std::numeric_limits<std::int64_t>::max();

std::int64_t usual_publication_utc_s(const LocalDate& delivery, int published_min) {
  const LocalDate before = add_days(delivery, -1);
  return utc_from_local({.year = before.year,
                         .month = before.month,
                         .day = before.day,
                         .hour = published_min / 60,
                         .minute = published_min % 60,
                         .second = 0});
}

}  // namespace

DayAheadPublication::DayAheadPublication(DayAheadSeries series, int published_min)
    : series_(std::move(series)) {
  known_utc_s_.reserve(series_.size());
  std::int64_t day_end = std::numeric_limits<std::int64_t>::min();
  std::int64_t usual = 0;
  for (std::size_t q = 0; q < series_.size(); ++q) {
    if (series_.utc_s(q) >= day_end) {
      const LocalDate delivery = local_date_of(series_.utc_s(q));
      day_end = local_midnight_utc_s(add_days(delivery, 1));
      usual = usual_publication_utc_s(delivery, published_min);
    }
    known_utc_s_.push_back(is_published(series_.eur_per_mwh[q])
                               ? std::max(usual, series_.published_utc_s[q])
                               : kNever_s);
  }
}

double DayAheadPublication::known_eur_per_mwh(std::int64_t utc_s, std::int64_t now_utc_s) const {
  if (utc_s < series_.start_utc_s || utc_s >= series_.end_utc_s()) return kNotPublished;
  const auto q = static_cast<std::size_t>((utc_s - series_.start_utc_s) / kSecondsPerQuarterHour);
  return known_utc_s_[q] <= now_utc_s ? series_.eur_per_mwh[q] : kNotPublished;
}

std::int64_t DayAheadPublication::next_known_utc_s(std::int64_t from_utc_s,
                                                   std::int64_t until_utc_s,
                                                   std::int64_t now_utc_s) const {
  std::int64_t next = kNever_s;
  const std::int64_t from = std::max(from_utc_s, series_.start_utc_s);
  const std::int64_t until = std::min(until_utc_s, series_.end_utc_s());
  for (std::int64_t utc_s = from; utc_s < until; utc_s += kSecondsPerQuarterHour) {
    const auto q = static_cast<std::size_t>((utc_s - series_.start_utc_s) / kSecondsPerQuarterHour);
    if (known_utc_s_[q] > now_utc_s) next = std::min(next, known_utc_s_[q]);
  }
  return next;
}

}  // namespace bess
