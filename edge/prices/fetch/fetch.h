// Fetch: one request to a price server, with its result in the edge's own terms.
#pragma once

#include <algorithm>
#include <cstdint>
#include <stop_token>
#include <string>

#include "edge/core/base/status.h"
#include "edge/prices/record/price_settings.h"
#include "edge/records/log/journal.h"
#include "shared/host/http_client.h"
#include "shared/scaled_clock.h"

namespace bess {

/// A line of bess-prices in the journal.
inline void say(JournalLevel level, const std::string& text) {
  write_journal_line(level, "bess-prices: " + text);
}

/// Waits for a wall time, or up to a tenth of a second beyond a stop request.
inline void pause(std::int64_t wall_ns, const std::stop_token& stop) {
  constexpr std::int64_t kSliceNs = kNanosecondsPerSecond / 10;
  for (; wall_ns > 0 && !stop.stop_requested(); wall_ns -= kSliceNs) {
    sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + std::min(wall_ns, kSliceNs));
  }
}

// Request timing of a minute's row: as soon as the source usually has it, within its rate limit.
// Pure; seconds of the edge's clock after the tick.

class AskTiming {
 public:
  /// Delay of the first request of a cycle.
  [[nodiscard]] std::int32_t first_s() const { return delay_s_; }
  [[nodiscard]] static std::int32_t spacing_s() { return kPriceWait_s / kPriceRequests; }

  /// Result of a cycle: whether the first request found the row, and whether one was refused as too
  /// many. A source that refuses is not asked earlier again.
  void learn(bool is_found_at_once, bool is_refused) {
    constexpr int kCyclesBeforeEarlier = 30;
    constexpr std::int32_t kLaterS = 3, kLeastLeftS = 2;
    has_refused_ = has_refused_ || is_refused;
    if (!is_found_at_once) {
      delay_s_ = std::min(delay_s_ + kLaterS, kPriceWait_s - kLeastLeftS);
      good_cycles_ = 0;
    } else if (!has_refused_ && delay_s_ > 0 && ++good_cycles_ >= kCyclesBeforeEarlier) {
      --delay_s_;
      good_cycles_ = 0;
    }
  }

 private:
  std::int32_t delay_s_ = 0;
  int good_cycles_ = 0;
  bool has_refused_ = false;
};

struct FetchResult {
  Status status = Status::kNotConnected;
  std::string body{};    ///< for kOk
  std::string reason{};  ///< for other statuses, one line with the remedy
  double wait_s = 0;     ///< requested by the server
};

/// GET of `url` with the settings' headers and CA file, and the smaller of both time-outs.
FetchResult fetch(const HttpSettings& settings, const std::string& url, std::int32_t timeout_ms,
                  const StopRequested& stop_requested,
                  std::size_t bytes_max = 4 * 1024 * 1024);  // 100 rows of ods161 are 27 kB

}  // namespace bess
