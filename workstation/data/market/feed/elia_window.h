// Download of one window: requests its rows with retries, compares them with the calendar and the
// server's total, and requests the rest until nothing is missing or the server has no more. The
// caller accepts or refuses the remaining gaps.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/data/market/feed/elia_fetch.h"
#include "workstation/data/market/feed/market_rows.h"
#include "workstation/data/market/series/gaps.h"

namespace bess {

struct WindowRows {
  MarketRows rows;
  std::size_t received = 0;          ///< rows before any was dropped
  bool is_elsewhere = false;         ///< rows received, none of the window
  std::size_t unended = 0;           ///< dropped: interval not ended
  std::optional<std::size_t> total;  ///< the server's count, if requested and plausible
  std::size_t distinct = 0;          ///< times with a row, if the total was requested

  [[nodiscard]] bool lacks_rows_of_total() const { return total && distinct + unended < *total; }
};

/// Ended rows of a text inside the window; none for an empty text. Throws UserError if it cannot be
/// read.
WindowRows rows_in_window(std::string_view text, const std::string& name, const FetchWindow& window,
                          std::int64_t now_utc_s);

/// Minutes or quarter-hours with a price.
std::size_t count_of(const MarketRows& rows);

/// Ended minutes or quarter-hours of the window by the UTC calendar: a local day with a clock
/// change has 92 or 100 quarter-hours.
std::size_t expected_rows(const FetchWindow& window, std::int64_t now_utc_s);

/// Ended parts of the window without a row of the window's kind.
std::vector<Gap> missing_in(const FetchWindow& window, const MarketRows& rows,
                            std::int64_t now_utc_s);
/// The same, including quarter-hours without a price, which cannot be settled.
std::vector<Gap> holes_in(const FetchWindow& window, const MarketRows& rows,
                          std::int64_t now_utc_s);

struct WindowDownload {
  std::string text;  ///< all answers joined; empty if not possible
  WindowRows rows;
};

/// Nothing if interrupted. Throws UserError if the server does not answer.
std::optional<WindowDownload> download_window(const FetchRequest& request,
                                              const FetchWindow& window,
                                              const std::atomic<bool>& interrupted);

/// A request and the texts of its retries.
struct RetriedRequest {
  std::string url;
  std::string label;       ///< of the lines on standard error
  std::string subject;     ///< of an error: what is requested from which server
  std::string again;       ///< remedy
  std::string again_then;  ///< remedy after a wait
};

/// Requests until `read` takes an answer; false if interrupted. `read` returns its argument, or
/// kRefused for an answer that is final, or kTransient for an unreadable one, which is requested
/// again, since a proxy may have changed it. Throws UserError after the last attempt.
bool get_with_retries(const RetriedRequest& request, const RetryPolicy& retry, const Sleep& sleep,
                      const std::atomic<bool>& interrupted,
                      const std::function<HttpOutcome(HttpOutcome)>& read);

/// "opendata.elia.be" of a URL.
std::string host_of(const std::string& url);

}  // namespace bess
