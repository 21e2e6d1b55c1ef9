#include "edge/fetch/day_ahead_feed.h"

#include <algorithm>
#include <cstdio>

#include "edge/fetch/fetch.h"
#include "edge/fetch/price_json.h"
#include "edge/log/whole_file.h"
#include "shared/local_time.h"

namespace bess {
namespace {

constexpr std::int64_t kShortestPauseS = 60;
constexpr int kDoublingsMax = 5;  // to half an hour
constexpr std::int64_t kLongestPauseS = 1'800;
constexpr std::int64_t kBeforePublicationS = 600;

FixedText<10> date_text(std::int64_t midnight_utc_s) {
  const LocalMinute day = local_minute_of(midnight_utc_s);
  char text[48];
  std::snprintf(text, sizeof text, "%04d-%02d-%02d", day.year, day.month, day.day);
  return {static_cast<const char*>(text)};
}

}  // namespace

std::string_view day_ahead_status_text(Status status, const OutlookSettings& settings) {
  switch (status) {
    case Status::kNotConnected:
      if (settings.file.empty()) break;
      return "the file is not there or cannot be read (is [outlook] file right, who writes it?)";
    case Status::kMalformed:
      return "not the JSON that [outlook] describes, or times that do not rise by quarter-hours "
             "(are rows_field, time_field and price_field right?)";
    case Status::kNoRow:
      return "no price of yesterday, today or tomorrow (are time_field, price_field and the dates "
             "of url right?)";
    case Status::kImplausible:
      return "contradicts what was published before, or repeats the day before: refused";
    default:
      break;
  }
  return price_status_text(status);
}

DayAheadUrl day_ahead_url(std::string_view url, const OutlookDays& days) {
  constexpr std::string_view kToday = "{today}";
  constexpr std::string_view kTomorrow = "{tomorrow}";
  const FixedText<10> today = date_text(days.today_utc_s);
  const FixedText<10> tomorrow = date_text(days.tomorrow_utc_s);
  char text[640];
  std::size_t size = 0;
  const auto add = [&](std::string_view part) {
    size += part.copy(text + size, sizeof text - size);
  };
  while (!url.empty()) {
    const bool is_today = url.starts_with(kToday);
    if (is_today || url.starts_with(kTomorrow)) {
      add(is_today ? today.view() : tomorrow.view());
      url.remove_prefix(is_today ? kToday.size() : kTomorrow.size());
    } else {
      add(url.substr(0, 1));
      url.remove_prefix(1);
    }
  }
  return {std::string_view(text, size)};
}

Status DayAheadFeed::fetch_answer(std::int64_t now_utc_s, std::string& answer) const {
  if (settings_.file.empty()) {
    const DayAheadUrl url =
        day_ahead_url(settings_.http.url.view(), outlook_days_around(now_utc_s));
    FetchResult fetched =
        fetch(settings_.http, url.c_str(), settings_.http.timeout_ms, stop_requested_);
    answer = std::move(fetched.body);
    return fetched.status;
  }
  constexpr std::size_t kFileBytesMax = 256 * 1024;
  answer.resize(kFileBytesMax);
  const ssize_t size = read_beginning(settings_.file.c_str(), answer, Links::kFollowed);
  if (size < 0) return Status::kNotConnected;
  answer.resize(static_cast<std::size_t>(size));
  return answer.size() == kFileBytesMax ? Status::kTooLarge : Status::kOk;
}

void DayAheadFeed::take_row(void* self, const PriceRow& row) {
  auto& feed = *static_cast<DayAheadFeed*>(self);
  feed.is_too_large_ = feed.count_ == kRowsMax;
  if (feed.is_too_large_) return;
  feed.rows_[feed.count_++] = {row.minute_utc_s, row.price_centi_eur_per_mwh};
}

Status DayAheadFeed::ask(std::int64_t now_utc_s) {
  count_ = 0;
  is_too_large_ = false;
  std::string answer;
  const Status fetched = fetch_answer(now_utc_s, answer);
  if (fetched != Status::kOk) return fetched;
  const Status parsed = parse_day_ahead(answer, settings_.fields, {this, take_row});
  return is_too_large_ ? Status::kTooLarge : parsed;
}

std::int64_t due_utc_s(const DayAheadBook& book, const OutlookSettings& settings,
                       std::int64_t now_utc_s) {
  const OutlookDays days = outlook_days_around(now_utc_s);
  if (!book.has_all(days.today_utc_s, days.tomorrow_utc_s, now_utc_s)) return now_utc_s;
  const bool has_tomorrow = book.has_all(days.tomorrow_utc_s, days.end_utc_s, now_utc_s);
  return settings.ask_offset_s - kBeforePublicationS +
         publication_utc_s(has_tomorrow ? days.tomorrow_utc_s : days.today_utc_s);
}

std::int64_t next_ask_utc_s(const DayAheadBook& book, const OutlookSettings& settings,
                            std::int64_t now_utc_s, std::int64_t last_utc_s, int tries) {
  const std::int64_t due = due_utc_s(book, settings, now_utc_s);
  const std::int64_t pause_s =
      std::min(kLongestPauseS, kShortestPauseS << std::min(std::max(tries - 1, 0), kDoublingsMax));
  // A clock that was stepped back must not keep it from asking.
  const bool may_ask_at_once = last_utc_s == 0 || last_utc_s > now_utc_s;
  return may_ask_at_once ? due : std::max(due, last_utc_s + pause_s);
}

bool DayAheadInquiry::take(Status asked, std::span<const TimedPrice> rows,
                           const OutlookSettings& settings, std::int64_t now_utc_s) {
  const std::uint32_t changes_before = book.changes();
  status = asked == Status::kOk ? book.take(rows, now_utc_s) : asked;
  last_utc_s = now_utc_s;
  tries = due_utc_s(book, settings, now_utc_s) > now_utc_s ? 0 : tries + 1;
  return book.changes() != changes_before;
}

}  // namespace bess
