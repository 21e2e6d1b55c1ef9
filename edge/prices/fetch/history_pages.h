// History pages: rows of the last days from the price server, before the loop starts, for the price
// level of a first start. Pages as in Opendatasoft v2.1 (limit, offset), newest rows first, so that
// rows received before a failure or the deadline have the largest weight.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include "edge/core/control/price_history.h"
#include "edge/prices/fetch/price_json.h"
#include "edge/prices/record/price_settings.h"
#include "shared/fixed_text.h"
#include "shared/scaled_clock.h"

namespace bess {

/// `url` with a limit of 100 rows and an offset, replacing its own.
std::string page_url(std::string_view url, int offset);

class HistoryPages {
 public:
  static constexpr int kRowsPerPage = 100;  ///< limits of the API
  static constexpr int kRowsMax = 10'000;
  static constexpr int kFailuresMax = 3;  ///< failed requests before giving up

  /// `url` as for the newest rows; its own limit and offset are replaced.
  HistoryPages(PriceHistory& history, std::string_view url) : history_(history), url_(url) {}

  /// Requests the next page. False if there is none: the hours are covered, the server has no older
  /// rows, or the request failed.
  template <typename Prices>
  bool fetch_next(Prices& prices, std::int32_t timeout_ms) {
    const std::int64_t oldest_before_utc_s = oldest_utc_s_;
    const PriceAnswer page = prices.fetch_page(page_url(url_.view(), offset_).c_str(), timeout_ms);
    for (const PriceRow& row : page.rows) take(row);
    return goes_on(page.status, page.items, oldest_before_utc_s);
  }
  /// Status of the last request; a page beyond the last row is no failure.
  [[nodiscard]] Status status() const { return status_; }
  [[nodiscard]] bool has_all_hours() const {
    return oldest_utc_s_ <= history_.first_minute_utc_s();
  }

 private:
  bool goes_on(Status status, int items, std::int64_t oldest_before_utc_s);
  void take(const PriceRow& row);

  PriceHistory& history_;
  FixedText<511> url_;
  int offset_ = 0;
  std::int64_t oldest_utc_s_ = INT64_MAX;
  Status status_ = Status::kOk;
};

/// Fills the history within kHistoryWait_s of the clock. Other than kOk: ended early; rows received
/// so far are kept. Runs on the caller's thread.
///   Prices  PriceAnswer fetch_page(const char* url, int32 timeout_ms)
///   Clock   monotonic_ns(), scaled(), stop_requested()
template <typename Prices, typename Clock>
Status fetch_history(Prices& prices, const PriceFeedSettings& price,
                     const HistorySettings& settings, Clock& clock, PriceHistory& history) {
  const std::int64_t deadline_ns =
      clock.monotonic_ns() + clock.scaled().wall_ns(kHistoryWait_s * kNanosecondsPerSecond);
  int failures = 0;
  for (const FixedText<511>& url : {price.http.url, settings.url}) {
    if (url.empty()) continue;
    HistoryPages pages(history, url.view());
    for (bool more = true; more;) {
      const std::int64_t left_ms = (deadline_ns - clock.monotonic_ns()) / 1'000'000;
      if (left_ms <= 0 || clock.stop_requested()) return Status::kTimeout;
      more = pages.fetch_next(prices, static_cast<std::int32_t>(
                                          std::min<std::int64_t>(left_ms, price.http.timeout_ms)));
      const bool may_repeat =
          pages.status() != Status::kOk && pages.status() != Status::kServerBusy;
      more = more || (may_repeat && ++failures < HistoryPages::kFailuresMax);
    }
    if (pages.status() != Status::kOk || pages.has_all_hours()) return pages.status();
  }
  return Status::kOk;
}

}  // namespace bess
