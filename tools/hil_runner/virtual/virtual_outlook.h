// Day-ahead prices and their plans in virtual time, for a student by outlook: the simulated
// auction's answers, read by the edge's own parser into its own book, planned on by its own
// planner. Looks up once in a cycle, where bess-prices has two threads; plans are never
// late.
#pragma once

#include <memory>

#include "edge/control/control_types.h"
#include "edge/fetch/day_ahead_feed.h"
#include "edge/fetch/outlook_fetcher.h"
#include "tools/hil_runner/scenario/scenario.h"
#include "tools/hil_runner/virtual/virtual_time.h"

namespace bess {

class VirtualOutlook {
 public:
  /// All must outlive this object, which goes on over restarts of the edge.
  VirtualOutlook(const Scenario& scenario, const OutlookSettings& settings,
                 const OutlookModel& model, VirtualTime& time);

  /// An edge starts: with what the one before kept, and one question.
  OutlookBoard* start(std::int32_t level_centi);
  /// After a cycle: asks where it is time to, and plans for the tick after it.
  void cycle_done(const CycleRecord& record);
  /// The state folder is lost.
  void lose() { kept_ = {}; }

 private:
  /// What ends with a process.
  struct Process {
    explicit Process(const OutlookModel& model) : planner(model, board) {}
    OutlookBoard board;
    OutlookPlanner planner;
    DayAheadInquiry inquiry;
  };
  void fetch(std::int64_t now_utc_s);
  [[nodiscard]] DayAheadAsked ask(std::int64_t now_utc_s) const;
  void plan(std::int64_t tick_utc_s, std::int32_t level_centi);
  [[nodiscard]] std::int64_t edge_utc_s() const;

  const OutlookSettings& settings_;
  const OutlookModel& model_;
  VirtualTime& time_;
  AuctionView auction_;
  DayAheadBook kept_;  ///< the edge's file
  std::unique_ptr<Process> process_;
};

}  // namespace bess
