// The plans that a policy by outlook has asked for so far: one a local day, rounded level and state
// of what is published. The plan itself is the edge's code (shared/outlook).
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

/// The days around a step with what of their day-ahead prices was published by then.
OutlookDays outlook_days_of(const MarketStep& step);

class OutlookBook {
 public:
  explicit OutlookBook(const OutlookModel& model) : model_(model) {}
  /// The book of this model: that of the last one asked for, if it is the same and in use. So
  /// teacher and student of a run look up one another's plans.
  static std::shared_ptr<const OutlookBook> of(const OutlookModel& model);

  [[nodiscard]] const OutlookModel& model() const { return model_; }
  /// Break-even price at a step; threads may share the book.
  [[nodiscard]] std::int32_t break_even_centi(const MarketStep& step, double soc_frac) const;
  /// The plan that it is of, for who asks at many SoCs.
  [[nodiscard]] std::shared_ptr<const OutlookPlan> plan_for(const MarketStep& step) const;
  /// Makes the plans of these days beforehand, on so many threads.
  void prepare(const MarketSteps& market, const std::vector<MarketDay>& days, int threads) const;

 private:
  /// A plan and the decisions that know no more than it does.
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
  mutable const DayAheadPublication* publication_ = nullptr;           ///< that the pages are of
};

}  // namespace bess
