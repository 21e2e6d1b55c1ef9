// Outlook threads of bess-prices, for a student by outlook: one fetches day-ahead prices, one plans
// for the tick after the newest decision, whose level it reads from the decision log.
//   server or file -> day_ahead_feed -> DayAheadStore -> OutlookPlanner -> the published record
//                                     stored on disk
#pragma once

#include <cstdint>
#include <mutex>
#include <stop_token>
#include <string>

#include "edge/app/settings/edge_config.h"
#include "edge/core/control/outlook.h"
#include "edge/prices/fetch/day_ahead_feed.h"
#include "edge/prices/fetch/price_fetcher.h"

namespace bess {

// Outlook planner: plans for the next ticks with the day-ahead prices known at the first of them,
// for the published record (../record/published_prices.h). The next level is within one decision's
// change of the last one, so at most two plans are needed, and mostly those of the previous tick
// serve. One thread at a time.

class OutlookPlanner {
 public:
  OutlookPlanner(const OutlookModel& model, OutlookExchange& exchange);

  /// Plans the day without day-ahead prices, as fallback.
  void plan_usual_day(std::int64_t utc_s, std::int32_t level_centi);
  struct PlanRequest {
    std::int64_t tick_utc_s = 0;
    std::int32_t level_centi = 0;  ///< level of the previous decision
    Status feed = Status::kOk;     ///< status of the last day-ahead request
  };
  /// Plans the rows from a tick on. `days`: prices known at that tick. Returns the number of new
  /// plans.
  int plan(const PlanRequest& request, const OutlookDays& days);

 private:
  struct CachedPlan {
    OutlookPlan plan;
    OutlookDays days;
    std::int32_t level_centi = 0;
    bool is_made = false;
    [[nodiscard]] bool is_of(const OutlookDays& other_days, std::int32_t other_level_centi) const {
      return is_made && level_centi == other_level_centi && days == other_days;
    }
  };

  /// The plan of a level; a plan that is not `needed` is replaced.
  const CachedPlan& plan_of(const OutlookDays& days, std::int32_t level_centi,
                            const CachedPlan* needed);

  const OutlookModel& model_;
  OutlookExchange& exchange_;
  CachedPlan cached_[OutlookPlanRows::kLevels] = {};
  int plans_made_ = 0;
};

class OutlookFetcher {
 public:
  OutlookFetcher(const EdgeConfig& config, const OutlookModel& model, PricePublisher& publisher,
                 const std::stop_token& stop);

  /// Restores the stored prices, fetches once, and plans for the first tick; `start_centi`: level
  /// if the log has none.
  void start(std::int32_t start_centi);
  /// The two threads, until a stop request.
  void fetch_until_stopped();
  void plan_until_stopped();

 private:
  struct Decision {
    std::int64_t tick_utc_s = 0;
    std::int32_t level_centi = 0;
    friend bool operator==(const Decision&, const Decision&) = default;
  };
  /// The next tick, at the level of the newest record.
  [[nodiscard]] Decision next_decision() const;
  void fetch(std::int64_t now_utc_s);
  void plan(const Decision& decision);
  void wait(std::int64_t simulated_ns) const;
  /// In simulated time not before the start of the simulation.
  [[nodiscard]] std::int64_t now_utc_s() const {
    return config_.clock.start_utc_ns() / kNanosecondsPerSecond;
  }

  const EdgeConfig& config_;
  PricePublisher& publisher_;
  std::stop_token stop_;
  const std::string kept_path_;
  OutlookExchange exchange_;
  OutlookPlanner planner_;
  std::int32_t start_centi_ = 0;
  std::mutex mutex_;  ///< protects the fetch state between the two threads
  DayAheadFetchState fetch_state_;
  std::uint64_t answers_ = 0;  ///< number of its changes
  bool is_kept_ = true;        ///< false: the file is out of date, and is retried
};

}  // namespace bess
