// What bess-prices does for a student by outlook: one thread fetches day-ahead prices, one plans on
// them for the tick after the newest decision, whose level it reads from the decision log.
//   server or file -> day_ahead_feed -> DayAheadBook -> OutlookPlanner -> the published record
//                                     kept on disk
#pragma once

#include <cstdint>
#include <mutex>
#include <stop_token>
#include <string>

#include "edge/app/settings/edge_config.h"
#include "edge/core/control/outlook.h"
#include "edge/prices/fetch/day_ahead_book.h"
#include "edge/prices/fetch/day_ahead_feed.h"
#include "edge/prices/fetch/price_fetcher.h"

namespace bess {

// Plans for the ticks ahead, from what is known of day-ahead prices at the next of them, and offers
// their rows to the control thread (../core/control/outlook.h). Never in a hurry: the next
// decision's level lies within one decision's move of the last one's, so that the plans of at most
// two levels are needed, and those of the tick before mostly serve. Nothing is allocated; one
// thread at a time.

class OutlookPlanner {
 public:
  OutlookPlanner(const OutlookModel& model, OutlookBoard& board);

  /// The day without day-ahead prices, for when nothing else is there. Before the loop starts.
  void plan_usual_day(std::int64_t utc_s, std::int32_t level_centi);
  struct Wanted {
    std::int64_t tick_utc_s = 0;
    std::int32_t level_centi = 0;  ///< of the decision before it
    Status feed = Status::kOk;     ///< how day-ahead prices were last answered
  };
  /// Offers the rows from a tick on. `days`: what is known at it. Returns how many plans had to be
  /// made for it.
  int plan(const Wanted& wanted, const OutlookDays& days);

 private:
  struct Made {
    OutlookPlan plan;
    OutlookDays days;
    std::int32_t level_centi = 0;
    bool is_made = false;
    [[nodiscard]] bool is_of(const OutlookDays& other_days, std::int32_t other_level_centi) const {
      return is_made && level_centi == other_level_centi && days == other_days;
    }
  };

  /// The plan of a level; one that is not `needed` gives its place to a new one.
  const Made& plan_of(const OutlookDays& days, std::int32_t level_centi, const Made* needed);

  const OutlookModel& model_;
  OutlookBoard& board_;
  Made made_[OutlookOffer::kLevels] = {};
  int plans_made_ = 0;
};

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
