#include "workstation/data/env/plan_cache.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "workstation/base/parallel_for.h"

namespace bess {
namespace {

constexpr std::size_t kPagesMax = 2500;  ///< 100 kB each

}  // namespace

OutlookDays outlook_days_of(const MarketStep& step) {
  OutlookDays days = outlook_days_around(step.utc_s);
  for (std::int64_t t = days.yesterday_utc_s; t < days.end_utc_s; t += kSecondsPerQuarterHour) {
    const double known = step.day_ahead_eur_per_mwh(t);
    if (is_published(known)) days.day_ahead_centi[days.index_of(t)] = price_centi_of(known);
  }
  return days;
}

std::shared_ptr<const PlanCache> PlanCache::of(const OutlookModel& model) {
  static std::mutex mutex;
  static std::weak_ptr<const PlanCache> last;
  const std::lock_guard lock(mutex);
  std::shared_ptr<const PlanCache> plan_cache = last.lock();
  if (plan_cache == nullptr || std::memcmp(&plan_cache->model_, &model, sizeof model) != 0) {
    last = plan_cache = std::make_shared<const PlanCache>(model);
  }
  return plan_cache;
}

void PlanCache::prepare(const MarketSteps& market, const std::vector<MarketDay>& days,
                        int threads) const {
  parallel_for(days.size(), threads, [&](std::size_t d) {
    for (const MarketStep& step : market.of(days[d])) (void)plan_for(step);
  });
}

std::shared_ptr<const OutlookPlan> PlanCache::plan_for(const MarketStep& step) const {
  std::unique_lock lock(mutex_);
  if (publication_ != step.day_ahead || page_count_ > kPagesMax) {
    publication_ = step.day_ahead;
    pages_.clear();
    page_count_ = 0;
  }
  if (step.utc_s < midnight_utc_s_ || step.utc_s >= next_midnight_utc_s_) {
    const OutlookDays days = outlook_days_around(step.utc_s);
    midnight_utc_s_ = days.today_utc_s;
    next_midnight_utc_s_ = days.tomorrow_utc_s;
  }
  const std::int32_t level = planned_level_centi(step.level_centi_eur_per_mwh);
  const Key key{midnight_utc_s_, level};
  std::vector<Page>& pages = pages_[key];
  const auto found = std::ranges::find_if(pages, [&](const Page& page) {
    return page.from_utc_s <= step.utc_s && step.utc_s < page.until_utc_s;
  });
  if (found != pages.end()) return found->plan;
  const OutlookDays days = outlook_days_of(step);
  std::int64_t until = days.tomorrow_utc_s;
  if (step.day_ahead != nullptr) {
    until = std::min(
        until, step.day_ahead->next_known_utc_s(days.yesterday_utc_s, days.end_utc_s, step.utc_s));
  }
  // Searched backwards: later pages know more.
  const auto known = std::ranges::find(pages, days, &Page::days);
  if (known != pages.end()) {
    known->from_utc_s = std::min(known->from_utc_s, step.utc_s);
    known->until_utc_s = std::max(known->until_utc_s, until);
    return known->plan;
  }
  lock.unlock();
  const auto plan = std::make_shared<OutlookPlan>();
  plan->make(model_, days, level);
  lock.lock();
  if (publication_ != step.day_ahead) return plan;  // another thread has changed the prices
  pages_[key].push_back({step.utc_s, until, days, plan});
  ++page_count_;
  return plan;
}

std::int32_t PlanCache::break_even_centi(const MarketStep& step, double soc_frac) const {
  const auto soc_e4 = static_cast<std::int32_t>(std::lround(soc_frac * kSocFullE4));
  return plan_for(step)->break_even_centi(model_, step.utc_s, soc_e4, step.level_centi_eur_per_mwh);
}

}  // namespace bess
