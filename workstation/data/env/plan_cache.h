// Cache of the plans of outlook policies, one for each local day, rounded level and publication
// state. The edge's code makes the plans (shared/outlook).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "shared/outlook/outlook_plan.h"
#include "workstation/data/env/market_steps.h"

namespace bess {

/// Days around a step with the day-ahead prices published by then.
OutlookDays outlook_days_of(const MarketStep& step);

class PlanCache {
 public:
  explicit PlanCache(const OutlookModel& model) : model_(model) {}
  /// Cache for this model; the latest one is reused if the model is equal, so that teacher and
  /// student of a run share plans.
  static std::shared_ptr<const PlanCache> of(const OutlookModel& model);

  [[nodiscard]] const OutlookModel& model() const { return model_; }
  /// Break-even price at a step; thread-safe.
  [[nodiscard]] std::int32_t break_even_centi(const MarketStep& step, double soc_frac) const;
  /// Plan of a step, for queries at many SoCs.
  [[nodiscard]] std::shared_ptr<const OutlookPlan> plan_for(const MarketStep& step) const;
  /// Makes the plans of these days in advance.
  void prepare(const MarketSteps& market, const std::vector<MarketDay>& days, int threads) const;

 private:
  /// A plan and the price state for which it is valid.
  struct Page {
    std::int64_t from_utc_s, until_utc_s;
    OutlookDays days;
    std::shared_ptr<const OutlookPlan> plan;
  };
  using Key = std::pair<std::int64_t, std::int32_t>;  ///< local midnight, level

  OutlookModel model_;
  mutable std::mutex mutex_;
  mutable std::map<Key, std::vector<Page>> pages_;
  mutable std::size_t page_count_ = 0;
  mutable std::int64_t midnight_utc_s_ = 0, next_midnight_utc_s_ = 0;  ///< of the newest step
  mutable const DayAheadPublication* publication_ = nullptr;           ///< publication of the pages
};

}  // namespace bess
