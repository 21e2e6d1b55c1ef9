// Price source in virtual time: answers of the simulated market, read by the edge's parser into its
// newest row. Requests as often as bess-prices.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "edge/core/control/control_types.h"
#include "edge/prices/fetch/day_ahead_feed.h"
#include "edge/prices/fetch/outlook_fetcher.h"
#include "edge/prices/fetch/price_json.h"
#include "edge/prices/record/newest_row.h"
#include "edge/prices/record/price_settings.h"
#include "tools/hil_runner/scenario/scenario.h"
#include "tools/hil_runner/virtual/virtual_time.h"
#include "tools/simulators/market_sim/market_fault.h"
#include "tools/simulators/market_sim/market_view.h"

namespace bess {

// Day-ahead prices and plans in virtual time, for a student with context outlook: answers of the
// simulated auction, read by the edge's parser and planned by its planner. Once per control cycle,
// where bess-prices has two threads; plans are never late.

class VirtualOutlook {
 public:
  /// All must outlive this object, which continues over restarts of the edge.
  VirtualOutlook(const Scenario& scenario, const OutlookSettings& settings,
                 const OutlookModel& model, VirtualTime& time);

  /// Start of an edge: stored prices, and one request.
  OutlookExchange* start(std::int32_t level_centi);
  /// After a control cycle: requests if due, and plans for the next tick.
  void cycle_done(const CycleRecord& record);
  /// Loses the stored prices.
  void lose() { kept_ = {}; }

 private:
  /// State that ends with a process.
  struct Process {
    explicit Process(const OutlookModel& model) : planner(model, exchange) {}
    OutlookExchange exchange;
    OutlookPlanner planner;
    DayAheadFetchState fetch_state;
  };
  void fetch(std::int64_t now_utc_s);
  [[nodiscard]] DayAheadReply ask(std::int64_t now_utc_s) const;
  void plan(std::int64_t tick_utc_s, std::int32_t level_centi);

  const OutlookSettings& settings_;
  const OutlookModel& model_;
  VirtualTime& time_;
  AuctionView auction_;
  DayAheadStore kept_;  ///< file of the edge
  std::unique_ptr<Process> process_;
};

class VirtualPrices {
 public:
  /// All but the settings must outlive this object; the fault plan continues over restarts.
  VirtualPrices(const PriceFeedSettings& settings, const MarketView& market,
                MarketFaultPlan& faults, const Scenario& scenario, VirtualTime& time);

  void request(std::int64_t minute_utc_s, std::int64_t start_monotonic_ns,
               std::int64_t deadline_monotonic_ns);
  bool wait(std::int64_t until_monotonic_ns);
  [[nodiscard]] PriceReport latest() const { return newest_.report(); }

  // One request with its duration, as bess-prices makes at the start.
  Status fetch_once(PriceRow& row);
  PriceAnswer fetch_page(const char* url, std::int32_t timeout_ms);

 private:
  /// Answer to a request now, and its duration.
  struct Reply {
    Status status = Status::kOk;
    std::string text{};
    std::int64_t takes_ns = 0;
  };
  struct Answer {
    Status status = Status::kTimeout;
    PriceRow row{};
    std::int64_t begun_ns = 0;
    std::int64_t done_ns = 0;
  };
  [[nodiscard]] bool begin_next();
  void fetch();
  [[nodiscard]] Reply ask(const RecordsQuery& query, std::int32_t timeout_ms);

  PriceFeedSettings settings_;
  const MarketView& market_;
  MarketFaultPlan& faults_;
  const Scenario& scenario_;
  VirtualTime& time_;
  NewestRow newest_;
  std::int64_t minute_utc_s_ = 0;
  std::int64_t start_ns_ = 0;
  std::int64_t deadline_ns_ = 0;
  std::int32_t requests_ = 0;  ///< in this control cycle
  bool is_asking_ = false;
  bool is_served_ = true;
  Answer answer_;
};

}  // namespace bess
