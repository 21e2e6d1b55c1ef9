// The outlook of a running controller: a thread that fetches day-ahead prices, and one that plans
// on them, below the control thread. It and they meet in an OutlookBoard; neither ever waits for
// the other. Both threads have static stacks, the fetching one draws from the arena, the planning
// one from nothing.
//
//   server or file -> DayAheadFeed -> DayAheadBook -> OutlookPlanner -> OutlookBoard -> cycle
//                                     kept on disk    at the level of the last decision
#pragma once

#include <semaphore.h>

#include <atomic>
#include <cstdint>
#include <mutex>

#include "edge/memory/static_thread.h"
#include "edge/outlook/day_ahead_feed.h"
#include "edge/outlook/outlook_planner.h"
#include "shared/scaled_clock.h"

namespace bess {

class OutlookWatch {
 public:
  OutlookWatch(const OutlookSettings& settings, const OutlookModel& model, const ScaledClock& clock,
               std::string_view kept_path);
  OutlookWatch(const OutlookWatch&) = delete;
  OutlookWatch& operator=(const OutlookWatch&) = delete;
  ~OutlookWatch();

  /// Takes what an earlier run kept, asks once, plans for the first tick at this level, and goes on
  /// in the background.
  void start(std::int32_t level_centi);
  /// From the control thread: plan for the tick after this one.
  void plan_after(std::int64_t tick_utc_s, std::int32_t level_centi);
  OutlookBoard& board() { return board_; }

 private:
  /// TLS as in price_feed.h.
  static constexpr std::size_t kFeedStackBytes = 1024 * 1024;
  /// Used: 40 KiB, of which a step of a plan 24; the rest for sanitizers.
  static constexpr std::size_t kPlanStackBytes = 256 * 1024;

  void fetch_for_ever();
  void plan_for_ever();
  void fetch(std::int64_t now_utc_s);
  void plan(std::int64_t tick_utc_s, std::int32_t level_centi);
  /// In simulated time not before the instant that it begins at.
  [[nodiscard]] std::int64_t now_utc_s() const;

  const OutlookSettings settings_;
  const ScaledClock clock_;
  const FixedText<639> kept_path_;
  DayAheadFeed feed_;
  OutlookBoard board_;
  OutlookPlanner planner_;
  std::mutex mutex_;  ///< of the inquiry, between the two threads
  DayAheadInquiry inquiry_;
  bool is_kept_ = true;  ///< false: the file lacks something, and is tried again
  /// Tick in steps of two minutes, and the level: in one word, as a hold.
  std::atomic<std::uint64_t> wanted_{0};
  sem_t ending_;
  sem_t to_plan_;
  std::atomic<bool> is_ending_{false};
  StaticThread<kFeedStackBytes> feed_thread_;
  StaticThread<kPlanStackBytes> plan_thread_;
};

}  // namespace bess
