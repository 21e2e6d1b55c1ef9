#include "edge/prices/fetch/price_fetcher.h"

#include <algorithm>
#include <memory>

#include "edge/core/control/price_history.h"

namespace bess {
namespace {

constexpr int kRowsPerPage = 100;  // limits of the API
constexpr int kRowsMax = 10'000;
constexpr int kFailuresMax = 3;  // failed requests before giving up

/// Pages of one URL.
struct HistoryPages {
  int offset = 0;
  std::int64_t oldest_utc_s = INT64_MAX;
  Status status = Status::kOk;  ///< of the last request; a page beyond the last row is no failure
};

/// False if there is no next page: the hours are covered, the server has no older rows, or the
/// request failed.
bool take(const PriceAnswer& page, HistoryPages& pages, PriceHistory& history) {
  const std::int64_t oldest_before_utc_s = pages.oldest_utc_s;
  for (const PriceRow& row : page.rows) {
    history.add(row.minute_utc_s, row.price_centi_eur_per_mwh);
    pages.oldest_utc_s = std::min(pages.oldest_utc_s, row.minute_utc_s);
  }
  const bool has_row = page.status != Status::kNoRow;
  pages.status = has_row ? page.status : Status::kOk;
  pages.offset += page.items;
  const bool is_older = pages.oldest_utc_s < oldest_before_utc_s;  // else the server has no pages
  return pages.status == Status::kOk && page.items > 0 && (is_older || !has_row) &&
         pages.oldest_utc_s > history.first_minute_utc_s() &&
         pages.offset + kRowsPerPage <= kRowsMax;
}

Status fill(PriceHistory& history, const PriceConfig& price, std::int64_t deadline_ns,
            const PageFetch& fetch_page, const std::function<bool()>& stop_requested) {
  int failures = 0;
  for (const FixedText<511>& url : {price.feed.http.url, price.history.url}) {
    if (url.empty()) continue;
    HistoryPages pages;
    for (bool more = true; more;) {
      const std::int64_t left_ms = (deadline_ns - clock_ns(CLOCK_MONOTONIC)) / 1'000'000;
      if (left_ms <= 0 || stop_requested()) return Status::kTimeout;
      const auto timeout_ms = std::min<std::int64_t>(left_ms, price.feed.http.timeout_ms);
      const std::string page = page_url(url.view(), pages.offset);
      more = take(fetch_page(page.c_str(), static_cast<std::int32_t>(timeout_ms)), pages, history);
      const bool may_repeat = pages.status != Status::kOk && pages.status != Status::kServerBusy;
      more = more || (may_repeat && ++failures < kFailuresMax);
    }
    const bool has_all_hours = pages.oldest_utc_s <= history.first_minute_utc_s();
    if (pages.status != Status::kOk || has_all_hours) return pages.status;
  }
  return Status::kOk;
}

}  // namespace

PublishedHistory fetch_history(const PriceConfig& price, const ScaledClock& clock,
                               const PageFetch& fetch_page,
                               const std::function<bool()>& stop_requested) {
  if (price.history.hours == 0) return {.is_done = true};
  const std::int64_t deadline_ns =
      clock_ns(CLOCK_MONOTONIC) + clock.wall_ns(kHistoryWait_s * kNanosecondsPerSecond);
  const auto history = std::make_unique<PriceHistory>(price.history.hours, utc_seconds(clock));
  const Status status = fill(*history, price, deadline_ns, fetch_page, stop_requested);
  return {.is_done = true,
          .hours = history->hours_covered(),
          .rows = history->rows(),
          .status = status,
          .level = history->level()};
}

std::string page_url(std::string_view url, int offset) {
  url = url.substr(0, url.find('#'));
  const std::size_t query_at = url.find('?');
  std::string page(url.substr(0, query_at));
  const char* separator = "?";
  std::string_view rest = query_at == std::string_view::npos ? "" : url.substr(query_at + 1);
  while (!rest.empty()) {
    const std::size_t end = rest.find('&');
    const std::string_view key = rest.substr(0, end);
    rest = end == std::string_view::npos ? "" : rest.substr(end + 1);
    if (key.starts_with("limit=") || key.starts_with("offset=")) continue;
    page.append(separator).append(key);
    separator = "&";
  }
  return page + separator + "limit=" + std::to_string(kRowsPerPage) +
         "&offset=" + std::to_string(offset);
}

}  // namespace bess
