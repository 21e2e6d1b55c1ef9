// The price source: its own thread fetches the newest minute rows over HTTP(S) and publishes the
// newest usable one as a fixed-size report. The only edge file pair that knows libcurl and cJSON.
// Prices leave here as integer hundredths of EUR/MWh. The control thread only waits on a condition
// with a deadline; a hanging server can delay a price, never the control loop.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string_view>
#include <thread>

#include "edge/control_types.h"
#include "shared/fixed_text.h"
#include "shared/scaled_clock.h"
#include "shared/status.h"

namespace bess {

struct PriceFeedSettings {
  FixedText<511> url;
  FixedText<255> ca_file;  ///< empty = the system's
  FixedText<31> rows_field = "results";
  FixedText<31> time_field = "datetime";
  FixedText<31> price_field = "imbalanceprice";
  std::int32_t timeout_ms = 5'000;  ///< of one request, wall time
  std::int32_t requests_per_cycle = 4;
  std::int32_t wait_s = 20;  ///< over which the requests of a cycle are spread
};

struct PriceRow {
  std::int64_t minute_utc_s = 0;
  std::int32_t price_centi_eur_per_mwh = 0;
};

/// Newest usable row of a JSON answer: a list under `rows_field`, or a bare list, in any order.
/// Rows without price, later than now, or beyond +-15,000 EUR/MWh are passed over.
Status parse_newest_price(std::string_view json, const PriceFeedSettings& settings,
                          std::int64_t now_utc_s, PriceRow& row);

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

 private:
  static constexpr std::size_t kAnswerBytesMax = 64 * 1024;  // 100 rows of ods161 are 27 kB

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
  static std::size_t on_bytes(char* bytes, std::size_t size, std::size_t count, void* feed);

  PriceFeedSettings settings_;
  ScaledClock clock_;
  void* curl_ = nullptr;
  std::size_t answer_size_ = 0;
  char answer_[kAnswerBytesMax];

  std::mutex mutex_;
  std::condition_variable changed_;
  Job job_;
  std::int64_t served_number_ = 0;
  bool stopping_ = false;
  PriceReport report_;
  std::thread thread_;  // last: starts when everything above is ready
};

}  // namespace bess
