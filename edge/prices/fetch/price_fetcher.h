// Imbalance price fetcher of bess-prices: one row per minute before a tick. Checks the unit,
// determines the level of a first start, and publishes. Blocking; on threads of main.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <string_view>

#include "edge/app/settings/edge_config.h"
#include "edge/prices/fetch/fetch.h"
#include "edge/prices/fetch/price_json.h"
#include "edge/prices/fetch/unit_watch.h"
#include "edge/prices/record/published_prices.h"
#include "shared/scaled_clock.h"

namespace bess {

// Price publisher: the record of published_prices.h, changed by several threads of bess-prices and
// rewritten after each change.

class PricePublisher {
 public:
  explicit PricePublisher(std::string path);

  /// Applies `change(prices)`, then writes the file. A write failure is logged once.
  template <typename Change>
  void publish(const Change& change) {
    const std::lock_guard lock(mutex_);
    change(prices_);
    write();
  }
  void publish_outlook(const OutlookExchange& exchange);

 private:
  void write();

  const std::string path_;
  std::mutex mutex_;
  PublishedPrices prices_;
  std::unique_ptr<PublishedOutlook> outlook_;
  bool is_failing_ = false;
};

// Requests to the price server, one at a time, on the caller's thread.

struct PriceReply {
  Status status = Status::kNotConnected;
  PriceRow newest{};
  int passed_over = 0;   ///< rows without a usable price
  std::string reason{};  ///< for statuses other than kOk
  double wait_s = 0;     ///< requested by the server
};

/// Passes each usable row to `watch`, oldest first.
PriceReply ask_price(const EdgeConfig& config, UnitWatch& watch, const std::stop_token& stop = {});
/// First request, with more rows if the server has pages, so that a wrong unit shows early.
PriceReply ask_first_price(const EdgeConfig& config, UnitWatch& watch,
                           const std::stop_token& stop = {});
/// Price level of the hours before now; for a first start.
PublishedHistory find_history(const EdgeConfig& config, const std::stop_token& stop = {});

// History pages: rows of the last days from the price server, before the loop starts, for the price
// level of a first start. Pages as in Opendatasoft v2.1 (limit, offset), newest rows first, so that
// rows received before a failure or the deadline have the largest weight.

/// `url` with a limit of 100 rows and an offset, replacing its own.
std::string page_url(std::string_view url, int offset);

using PageFetch = std::function<PriceAnswer(const char* url, std::int32_t timeout_ms)>;

/// Price level of the hours before now, within kHistoryWait_s. Status other than kOk: ended early;
/// rows received so far count. Runs on the caller's thread.
PublishedHistory fetch_history(const PriceConfig& price, const ScaledClock& clock,
                               const PageFetch& fetch_page,
                               const std::function<bool()>& stop_requested);

class PriceFetcher {
 public:
  PriceFetcher(const EdgeConfig& config, PricePublisher& publisher, std::stop_token stop)
      : config_(config), publisher_(publisher), stop_(std::move(stop)) {}

  /// Runs until a stop request, or `is_over` after a cycle: one initial request, then those of each
  /// cycle.
  void run(const std::function<bool()>& is_over);

 private:
  void serve(std::int64_t tick_utc_s);
  PriceReply publish(PriceReply answer, std::int64_t begin_ns);
  /// Sleeps in slices; false on a stop request. A clock step backwards ends the wait.
  bool sleep_until(std::int64_t utc_s) const;

  const EdgeConfig& config_;
  PricePublisher& publisher_;
  std::stop_token stop_;
  AskTiming timing_;
  UnitWatch unit_;
  Status reported_ = Status::kOk;      ///< status of the last line in the journal
  std::int64_t not_before_utc_s_ = 0;  ///< requested by the server
  std::int64_t busy_utc_s_ = 0;        ///< time of that request
};

}  // namespace bess
