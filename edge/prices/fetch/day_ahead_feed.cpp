#include "edge/prices/fetch/day_ahead_feed.h"

#include <algorithm>

#include "edge/prices/fetch/fetch.h"
#include "edge/records/log/atomic_file.h"
#include "shared/host/text.h"
#include "shared/training_period.h"
#include "shared/utc_text.h"

namespace bess {

namespace {

constexpr std::string_view kHead =
    "# bess day-ahead 1: quarter-hour, hundredths of EUR/MWh, received\n";
constexpr std::size_t kUtcBytes = 20;
constexpr std::size_t kLineBytesMax = 2 * kUtcBytes + 12;
constexpr std::size_t kFileBytesMax =
    kHead.size() + DayAheadStore::kPricesMax * kLineBytesMax + sizeof "# crc32=01234567\n";

/// False for a line in another format.
bool parse_line(std::string_view line, KnownPrice& price) {
  const std::size_t first = line.find(' ');
  const std::size_t last = line.rfind(' ');
  if (first == line.npos || first == last) return false;
  const std::string_view centi = line.substr(first + 1, last - first - 1);
  return read_number(centi, price.centi_eur_per_mwh) &&
         parse_utc(line.substr(0, first), price.utc_s) &&
         parse_utc(line.substr(last + 1), price.received_utc_s);
}

}  // namespace

bool keep_day_ahead(const char* path, const DayAheadStore& store) {
  std::string text(kHead);
  for (const KnownPrice& price : store.prices()) {
    if (price.utc_s == 0 || price.is_assumed) continue;
    add_formatted(text, "%s %d %s\n", utc_text(price.utc_s).c_str(), price.centi_eur_per_mwh,
                  utc_text(price.received_utc_s).c_str());
  }
  text += checksum_end(text, kCommentChecksum).view();
  return replace_file_durably(path, text);
}

int restore_day_ahead(const char* path, DayAheadStore& store) {
  std::string text(kFileBytesMax, '\0');
  const ssize_t size = read_beginning(path, text, SymlinkPolicy::kRefused);
  if (size <= 0) return 0;
  std::string_view rest(text.data(), static_cast<std::size_t>(size));
  if (!rest.starts_with(kHead) || check_text(rest, kCommentChecksum) != ChecksumState::kIntact)
    return 0;
  rest = without_checksum(rest, kCommentChecksum).substr(kHead.size());
  int prices = 0;
  while (!rest.empty()) {
    KnownPrice price;
    if (parse_line(take_line(rest), price) && store.restore(price)) ++prices;
  }
  return prices;
}

namespace {

constexpr std::int64_t kShortestPauseS = 60;
constexpr int kDoublingsMax = 5;  // up to half an hour
constexpr std::int64_t kLongestPauseS = 1'800;
constexpr std::int64_t kBeforePublicationS = 600;

}  // namespace

std::string_view day_ahead_status_text(Status status, const OutlookSettings& settings) {
  switch (status) {
    case Status::kNotConnected:
      if (settings.file.empty()) break;
      return "the file is missing or unreadable (check [outlook] file and its writing program)";
    case Status::kMalformed:
      return "not the JSON that [outlook] describes, or times not in steps of quarter-hours "
             "(check rows_field, time_field and price_field)";
    case Status::kNoRow:
      return "no price for yesterday, today or tomorrow (check time_field, price_field and the "
             "dates of url)";
    case Status::kImplausible:
      return "refused: contradicts published prices, repeats the previous day, or is constant all "
             "day (check the zone and dates of url or file; it is requested again)";
    case Status::kDoubtfulUnit:
      return "a day of prices within 5 EUR/MWh: another unit? [outlook] needs EUR/MWh";
    default:
      break;
  }
  return price_status_text(status);
}

std::string day_ahead_url(std::string_view url, const OutlookDays& days) {
  std::string text(url);
  replace_all(text, "{today}", local_date_text(days.today_utc_s).view());
  replace_all(text, "{tomorrow}", local_date_text(days.tomorrow_utc_s).view());
  return text;
}

DayAheadReply read_day_ahead(std::string_view answer, const PriceFields& fields) {
  DayAheadAnswer parsed = parse_day_ahead_json(
      answer,
      {.rows = fields.rows.view(), .time = fields.time.view(), .price = fields.price.view()});
  if (!parsed.trouble.empty()) return {.status = Status::kMalformed, .reason = parsed.trouble};
  DayAheadLayout layout = lay_out_day_ahead(std::move(parsed.rows));
  // Two prices for one time are ambiguous.
  if (!layout.trouble.empty() || layout.contradiction_utc_s != 0) {
    return {
        .status = Status::kMalformed,
        .reason = layout.trouble.empty()
                      ? "two prices for " + std::string(utc_text(layout.contradiction_utc_s).view())
                      : layout.trouble};
  }
  return {.status = Status::kOk, .days = std::move(layout.days)};
}

DayAheadReply ask_day_ahead(const OutlookSettings& settings, std::int64_t now_utc_s,
                            const StopRequested& stop_requested) {
  if (settings.file.empty()) {
    const std::string url = day_ahead_url(settings.http.url.view(), outlook_days_around(now_utc_s));
    FetchResult fetched = fetch(settings.http, url, settings.http.timeout_ms, stop_requested);
    if (fetched.status != Status::kOk) {
      return {
          .status = fetched.status, .reason = std::move(fetched.reason), .wait_s = fetched.wait_s};
    }
    return read_day_ahead(fetched.body, settings.fields);
  }
  constexpr std::size_t kAnswerBytesMax = 256 * 1024;
  std::string answer(kAnswerBytesMax, 0);
  const ssize_t size = read_beginning(settings.file.c_str(), answer, SymlinkPolicy::kFollowed);
  if (size < 0) return {.status = Status::kNotConnected};
  answer.resize(static_cast<std::size_t>(size));
  if (answer.size() == kAnswerBytesMax) return {.status = Status::kTooLarge};
  return read_day_ahead(answer, settings.fields);
}

std::int64_t due_utc_s(const DayAheadStore& store, const OutlookSettings& settings,
                       std::int64_t now_utc_s) {
  const OutlookDays days = outlook_days_around(now_utc_s);
  if (!store.has_all(days.today_utc_s, days.tomorrow_utc_s, now_utc_s)) return now_utc_s;
  const bool has_tomorrow = store.has_all(days.tomorrow_utc_s, days.end_utc_s, now_utc_s);
  return settings.ask_offset_s - kBeforePublicationS +
         publication_utc_s(has_tomorrow ? days.tomorrow_utc_s : days.today_utc_s);
}

std::int64_t next_ask_utc_s(const DayAheadStore& store, const OutlookSettings& settings,
                            std::int64_t now_utc_s, std::int64_t last_utc_s, int tries,
                            double wait_s) {
  const std::int64_t due = due_utc_s(store, settings, now_utc_s);
  const std::int64_t pause_s = std::max(
      std::min(kLongestPauseS, kShortestPauseS << std::min(std::max(tries - 1, 0), kDoublingsMax)),
      static_cast<std::int64_t>(wait_s));
  // A clock step backwards must not block requests.
  const bool may_ask_at_once = last_utc_s == 0 || last_utc_s > now_utc_s;
  return may_ask_at_once ? due : std::max(due, last_utc_s + pause_s);
}

bool DayAheadFetchState::take(const DayAheadReply& reply, const OutlookSettings& settings,
                              std::int64_t now_utc_s) {
  const std::uint32_t changes_before = store.changes();
  status = reply.status == Status::kOk ? store.take(reply.days, now_utc_s) : reply.status;
  reason =
      reply.reason.empty() ? std::string(day_ahead_status_text(status, settings)) : reply.reason;
  last_utc_s = now_utc_s;
  wait_s = reply.wait_s;
  tries = due_utc_s(store, settings, now_utc_s) > now_utc_s ? 0 : tries + 1;
  return store.changes() != changes_before;
}

}  // namespace bess
