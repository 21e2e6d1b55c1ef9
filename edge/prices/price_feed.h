// The price source: its own thread fetches the newest minute rows over HTTP(S) and publishes the
// newest usable one as a fixed-size report: http_client -> price_json -> PriceFeed -> ControlLoop.
// The control thread only waits on a condition with a deadline; a hanging server or name server can
// delay a price, never the control loop. The thread exists from the constructor on, on a stack
// inside this object, and draws only from the static arena.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>

#include "edge/base/status.h"
#include "edge/control/control_types.h"
#include "edge/memory/static_thread.h"
#include "edge/prices/http_client.h"
#include "edge/prices/newest_row.h"
#include "edge/prices/price_json.h"
#include "shared/scaled_clock.h"

namespace bess {

struct PriceFeedSettings {
  HttpSettings http;
  PriceFields fields;
  std::int32_t requests_per_cycle = 4;
  std::int32_t wait_s = 20;  ///< over which the requests of a cycle are spread
  std::int32_t step_flag_centi_eur_per_mwh = 230'000;  ///< a larger step is flagged
  bool hold_flagged_step = true;                       ///< and held until the next row confirms it
};

/// What a status means when it comes from the price server, and what mends it.
std::string_view price_status_text(Status status);

class PriceFeed {
 public:
  PriceFeed(const PriceFeedSettings& settings, const ScaledClock& clock);
  PriceFeed(const PriceFeed&) = delete;
  PriceFeed& operator=(const PriceFeed&) = delete;
  ~PriceFeed();

  /// From `start` on fetches until the row of `minute_utc_s` is in, the requests are used up or the
  /// deadline has passed.
  void request(std::int64_t minute_utc_s, std::int64_t start_monotonic_ns,
               std::int64_t deadline_monotonic_ns);
  /// Waits for the end of the request, at most until the instant given; true when it has ended.
  bool wait(std::int64_t until_monotonic_ns);
  PriceReport latest();

  /// One request on the caller's thread, for checking the configuration before the loop starts.
  Status fetch_once(PriceRow& row);
  /// One page of rows from a URL of the same host, likewise; `items` as parse_prices has it.
  Status fetch_page(const char* url, std::int32_t timeout_ms, const PriceRowTaker& taker,
                    int& items);

 private:
  /// Measured: 16 KiB; JSON may nest, and ThreadSanitizer refuses less than 0.9 MiB.
  static constexpr std::size_t kStackBytes = 1024 * 1024;

  struct Job {
    std::int64_t minute_utc_s = 0;
    std::int64_t start_ns = 0;
    std::int64_t deadline_ns = 0;
    std::int64_t number = 0;
  };

  void run();
  void serve(const Job& job);
  void publish(Status status, const PriceRow& row, std::int64_t start_ns);
  bool pause_until(std::int64_t until_ns);

  PriceFeedSettings settings_;
  ScaledClock clock_;
  HttpClient http_;

  std::mutex mutex_;
  std::condition_variable changed_;
  Job job_;
  std::int64_t served_number_ = 0;
  bool stopping_ = false;
  NewestRow newest_;
  StaticThread<kStackBytes> thread_;
};

}  // namespace bess
