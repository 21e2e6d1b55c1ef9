// One window of a download: asks for its rows, tries again where that can help, counts what came
// against the calendar and against the server's own total, and asks for the rest until nothing is
// missing or the server has no more. What is missing then is the caller's to accept or refuse.
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
  std::size_t received = 0;          ///< before any was dropped
  bool is_elsewhere = false;         ///< rows came, and none of the window
  std::size_t unended = 0;           ///< dropped: of intervals that had not ended
  std::optional<std::size_t> total;  ///< the server's count, when it was asked and can be believed
  std::size_t distinct = 0;          ///< times that have a row, where the total was asked for

  [[nodiscard]] bool lacks_rows_of_total() const { return total && distinct + unended < *total; }
};

/// The rows of a text that lie in the window and have ended. An empty text holds none. Throws
/// UserError when it cannot be read.
WindowRows rows_in_window(std::string_view text, const std::string& name, const FetchWindow& window,
                          std::int64_t now_utc_s);

/// Minutes or quarter-hours with a price.
std::size_t count_of(const MarketRows& rows);

/// Minutes or quarter-hours of the window that have ended, by the calendar of UTC: a local day of a
/// clock change has 92 or 100 quarter-hours by itself.
std::size_t expected_rows(const FetchWindow& window, std::int64_t now_utc_s);

/// Stretches of the window that have ended and have no row of the window's kind.
std::vector<Gap> missing_in(const FetchWindow& window, const MarketRows& rows,
                            std::int64_t now_utc_s);
/// The same, and quarter-hours whose row has no price: nobody will be paid for them.
std::vector<Gap> holes_in(const FetchWindow& window, const MarketRows& rows,
                          std::int64_t now_utc_s);

struct WindowDownload {
  std::string text;  ///< all answers as one; empty when they cannot be joined
  WindowRows rows;
};

/// Nothing when interrupted. Throws UserError when the server cannot be made to answer.
std::optional<WindowDownload> download_window(const FetchRequest& request,
                                              const FetchWindow& window,
                                              const std::atomic<bool>& interrupted);

/// "opendata.elia.be" of an address.
std::string host_of(const std::string& url);

}  // namespace bess
