// What bess-prices does for a student by outlook: one thread fetches day-ahead prices, one plans on
// them for the tick after the newest decision, whose level it reads from the decision log.
//   server or file -> day_ahead_feed -> DayAheadBook -> OutlookPlanner -> the published record
//                                     kept on disk
#pragma once

#include <cstdint>
#include <mutex>
#include <stop_token>
#include <string>

#include "edge/fetch/day_ahead_feed.h"
#include "edge/fetch/outlook_planner.h"
#include "edge/fetch/price_publisher.h"
#include "edge/settings/edge_config.h"

namespace bess {

class OutlookFetcher {
 public:
  OutlookFetcher(const EdgeConfig& config, const OutlookModel& model, PricePublisher& publisher,
                 const std::stop_token& stop);

  /// Takes what an earlier run kept, asks once, and plans for the first tick; `start_centi`: the
  /// level where the log has none.
  void start(std::int32_t start_centi);
  /// The two threads, until a stop is requested.
  void fetch_for_ever();
  void plan_for_ever();

 private:
  struct Decision {
    std::int64_t tick_utc_s = 0;
    std::int32_t level_centi = 0;
    friend bool operator==(const Decision&, const Decision&) = default;
  };
  /// Of the tick to come, at the level of the newest record.
  [[nodiscard]] Decision next_decision() const;
  void fetch(std::int64_t now_utc_s);
  void plan(const Decision& decision);
  void wait(std::int64_t simulated_ns) const;
  /// In simulated time not before the instant that it begins at.
  [[nodiscard]] std::int64_t now_utc_s() const {
    return config_.clock.start_utc_ns() / kNanosecondsPerSecond;
  }

  const EdgeConfig& config_;
  PricePublisher& publisher_;
  std::stop_token stop_;
  const std::string kept_path_;
  OutlookBoard board_;
  OutlookPlanner planner_;
  std::int32_t start_centi_ = 0;
  std::mutex mutex_;  ///< of the inquiry, between the two threads
  DayAheadInquiry inquiry_;
  std::uint64_t answers_ = 0;  ///< so many changes of the inquiry
  bool is_kept_ = true;        ///< false: the file lacks something, and is tried again
};

}  // namespace bess
