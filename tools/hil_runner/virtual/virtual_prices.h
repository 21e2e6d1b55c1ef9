// The control loop's price source in virtual time: the answers of the simulated market, read by the
// edge's own parser into its own newest row. Asks as often as bess-prices would.
#pragma once

#include <cstdint>
#include <string>

#include "edge/fetch/price_json.h"
#include "edge/prices/newest_row.h"
#include "edge/prices/price_settings.h"
#include "tools/hil_runner/scenario/scenario.h"
#include "tools/hil_runner/virtual/virtual_time.h"
#include "tools/market_sim/market_fault.h"
#include "tools/market_sim/market_view.h"

namespace bess {

class VirtualPrices {
 public:
  /// All but the settings must outlive this object; the plan goes on over restarts of the edge.
  VirtualPrices(const PriceFeedSettings& settings, const MarketView& market,
                MarketFaultPlan& faults, const Scenario& scenario, VirtualTime& time);

  void request(std::int64_t minute_utc_s, std::int64_t start_monotonic_ns,
               std::int64_t deadline_monotonic_ns);
  bool wait(std::int64_t until_monotonic_ns);
  [[nodiscard]] PriceReport latest() const { return newest_.report(); }

  // One request, which takes its time, as bess-prices has them for the start.
  Status fetch_once(PriceRow& row);
  PriceAnswer fetch_page(const char* url, std::int32_t timeout_ms);

 private:
  /// What the server answers to a request of now, and how long that takes.
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
  [[nodiscard]] std::int64_t edge_utc_s() const;
  [[nodiscard]] Reply ask(RecordsQuery query, std::int32_t timeout_ms);

  PriceFeedSettings settings_;
  const MarketView& market_;
  MarketFaultPlan& faults_;
  const Scenario& scenario_;
  VirtualTime& time_;
  NewestRow newest_;
  std::int64_t minute_utc_s_ = 0;
  std::int64_t start_ns_ = 0;
  std::int64_t deadline_ns_ = 0;
  std::int32_t requests_ = 0;  ///< begun in this cycle
  bool is_asking_ = false;
  bool is_served_ = true;
  Answer answer_;
};

}  // namespace bess
