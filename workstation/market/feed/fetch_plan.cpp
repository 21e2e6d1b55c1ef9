#include "workstation/market/feed/fetch_plan.h"

#include <algorithm>

#include "shared/host/user_error.h"

namespace bess {
namespace {

/// First day of the local mFRR market and its datasets.
constexpr LocalDate kNewDatasets{2024, 5, 22};

struct DatasetPair {
  const char* minutes;
  const char* quarter_hours;
};

constexpr DatasetPair kOld{"ods046", "ods047"};
constexpr DatasetPair kNew{"ods133", "ods134"};
constexpr DatasetPair kToday{"ods161", "ods162"};

/// A dataset of the day may be refreshed a day late.
constexpr int kFillingDays = 2;

DatasetPair datasets_of(const LocalDate& day, const LocalDate& today) {
  if (day == today) return kToday;
  return day < kNewDatasets ? kOld : kNew;
}

LocalDate next_month(const LocalDate& day) {
  return day.month == 12 ? LocalDate{day.year + 1, 1, 1} : LocalDate{day.year, day.month + 1, 1};
}

/// First day of the next window: month's end, change of datasets, the days that may still be
/// filling, today, or the span's end.
LocalDate window_end(const LocalDate& from, const LocalDate& end, const LocalDate& today) {
  LocalDate until = std::min(end, next_month(from));
  for (const LocalDate& border : {kNewDatasets, add_days(today, -kFillingDays), today}) {
    if (from < border) until = std::min(until, border);
  }
  return until;
}

}  // namespace

bool is_near_real_time(std::string_view dataset) {
  return dataset == kToday.minutes || dataset == kToday.quarter_hours;
}

bool holds_minutes(std::string_view dataset) {
  return dataset == kOld.minutes || dataset == kNew.minutes || dataset == kToday.minutes;
}

std::vector<FetchWindow> plan_fetch(const FetchSpan& span, std::int64_t now_utc_s) {
  if (span.to < span.from) {
    fail("--to {} is before --from {}; swap them", format_local_date(span.to),
         format_local_date(span.from));
  }
  const LocalDate today = local_date_of(now_utc_s);
  if (today < span.from) {
    fail("--from {} is in the future; prices exist until today", format_local_date(span.from));
  }
  const LocalDate end = add_days(std::min(span.to, today), 1);
  std::vector<FetchWindow> windows;
  for (LocalDate from = span.from; from < end;) {
    const LocalDate until = window_end(from, end, today);
    const DatasetPair datasets = datasets_of(from, today);
    const std::int64_t until_utc_s = local_midnight_utc_s(until);
    const bool settles_later = until_utc_s > now_utc_s - kFillingDays * 86'400;
    for (const char* dataset : {datasets.minutes, datasets.quarter_hours}) {
      windows.push_back({dataset, local_midnight_utc_s(from), until_utc_s, settles_later});
    }
    from = until;
  }
  return windows;
}

}  // namespace bess
