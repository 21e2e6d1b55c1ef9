#include "edge/prices/fetch/outlook_fetcher.h"

#include <algorithm>

#include "edge/core/control/level_start.h"
#include "edge/prices/fetch/day_ahead_feed.h"
#include "edge/prices/fetch/fetch.h"
#include "edge/records/log/log_reader.h"
#include "shared/local_time.h"
#include "shared/price_level.h"

namespace bess {

namespace {

/// Largest change of the trailing level by one decision, plus a cent for rounding.
constexpr std::int32_t kLevelMoveMaxCenti =
    (PriceLevel::kMaxCenti - PriceLevel::kMinCenti) / static_cast<int>(PriceLevel::kDecisions) + 2;
static_assert(kLevelMoveMaxCenti < kPlannedLevelCenti, "two plans would not suffice");

/// Describes the published prices from the tick's quarter-hour on.
void describe(const OutlookDays& days, std::int64_t tick_utc_s, OutlookPlanRows& plan_rows) {
  const std::int64_t now = tick_utc_s - tick_utc_s % kSecondsPerQuarterHour;
  plan_rows.is_published = days.day_ahead_centi[days.index_of(now)] != kDayAheadUnknown;
  plan_rows.known_quarter_hours = 0;
  plan_rows.dearest = plan_rows.cheapest = {};
  for (std::int64_t t = now; t < days.end_utc_s; t += kSecondsPerQuarterHour) {
    const std::int32_t centi = days.day_ahead_centi[days.index_of(t)];
    if (centi == kDayAheadUnknown) continue;
    const bool is_first = plan_rows.known_quarter_hours++ == 0;
    if (is_first || centi > plan_rows.dearest.centi_eur_per_mwh) plan_rows.dearest = {t, centi};
    if (is_first || centi < plan_rows.cheapest.centi_eur_per_mwh) plan_rows.cheapest = {t, centi};
  }
}

}  // namespace

OutlookPlanner::OutlookPlanner(const OutlookModel& model, OutlookExchange& exchange)
    : model_(model), exchange_(exchange) {
  exchange.model = &model;
}

/// An hour skipped by daylight saving time gets the row of the previous one.
void OutlookPlanner::plan_usual_day(std::int64_t utc_s, std::int32_t level_centi) {
  const OutlookDays days = outlook_days_around(utc_s);
  const CachedPlan& cached = plan_of(days, planned_level_centi(level_centi), nullptr);
  UsualDay& usual = exchange_.usual;
  usual.level_centi = cached.level_centi;
  int quarter_hour = 0;
  for (std::int64_t t = days.today_utc_s; t < days.tomorrow_utc_s; t += kSecondsPerQuarterHour) {
    const int now = local_minute_of(t).quarter_hour;
    const BreakEvenRow& row = cached.plan.row_at(t);
    while (quarter_hour < now) usual.rows[quarter_hour++] = row;
    usual.rows[now] = row;
    quarter_hour = std::max(quarter_hour, now + 1);
  }
}

const OutlookPlanner::CachedPlan& OutlookPlanner::plan_of(const OutlookDays& days,
                                                          std::int32_t level_centi,
                                                          const CachedPlan* needed) {
  for (const CachedPlan& cached : cached_) {
    if (cached.is_of(days, level_centi)) return cached;
  }
  CachedPlan& place = &cached_[0] == needed ? cached_[1] : cached_[0];
  place.plan.make(model_, days, level_centi);
  place.days = days;
  place.level_centi = level_centi;
  place.is_made = true;
  ++plans_made_;
  return place;
}

int OutlookPlanner::plan(const PlanRequest& request, const OutlookDays& days) {
  const int made_before = plans_made_;
  const std::int64_t tick_utc_s = request.tick_utc_s;
  OutlookPlanRows& plan_rows = exchange_.plan_rows;
  plan_rows.first_tick_utc_s = tick_utc_s;
  plan_rows.feed = request.feed;
  const std::int64_t left = (days.tomorrow_utc_s - tick_utc_s) / kSecondsPerStep;
  plan_rows.ticks = static_cast<int>(std::min<std::int64_t>(left, OutlookPlanRows::kTicks));
  const std::int32_t low_centi = planned_level_centi(request.level_centi - kLevelMoveMaxCenti);
  const std::int32_t high_centi = planned_level_centi(request.level_centi + kLevelMoveMaxCenti);
  const CachedPlan* needed = nullptr;
  for (const CachedPlan& cached : cached_) {  // of two needed plans, neither may replace the other
    if (cached.is_of(days, high_centi)) needed = &cached;
  }
  plan_rows.levels = low_centi == high_centi ? 1 : 2;
  for (int i = 0; i < plan_rows.levels; ++i) {
    const CachedPlan& cached = plan_of(days, i == 0 ? low_centi : high_centi, needed);
    needed = &cached;
    plan_rows.level_centi[i] = cached.level_centi;
    for (int tick = 0; tick < plan_rows.ticks; ++tick) {
      plan_rows.rows[i][tick] = cached.plan.row_at(tick_utc_s + tick * kSecondsPerStep);
    }
  }
  describe(days, tick_utc_s, plan_rows);
  return plans_made_ - made_before;
}

OutlookFetcher::OutlookFetcher(const EdgeConfig& config, const OutlookModel& model,
                               PricePublisher& publisher, const std::stop_token& stop)
    : config_(config),
      publisher_(publisher),
      stop_(stop),
      kept_path_(state_file(config, kDayAheadFileName).view()),
      planner_(model, exchange_) {}

void OutlookFetcher::start(std::int32_t start_centi) {
  start_centi_ = start_centi;
  const std::int64_t now = now_utc_s();
  const int kept = restore_day_ahead(kept_path_.c_str(), fetch_state_.store);
  fetch(now);
  say(JournalLevel::kNotice,
      "outlook: " + std::to_string(kept) +
          " stored day-ahead prices; request for more: " + fetch_state_.reason);
  const Decision decision = next_decision();
  planner_.plan_usual_day(now, decision.level_centi);
  plan(decision);
}

OutlookFetcher::Decision OutlookFetcher::next_decision() const {
  Decision next{next_tick_utc_s(now_utc_s() - 1), start_centi_};
  LogReader log;
  FileMessage ignored;
  CycleRecord newest;
  if (!log.open(config_.log, ignored) || !log.newest(newest)) return next;
  const PriceLevel level = level_from_log(newest.price_level, now_utc_s());
  if (level.is_known()) next.level_centi = level.centi_eur_per_mwh();
  // A running controller decides some seconds after its tick: until then its plan stays.
  constexpr std::int64_t kLateSMax = 90;
  const std::int64_t after_newest_s = newest.utc_s + kSecondsPerStep;
  const std::int64_t now = now_utc_s();
  const bool is_awaited =
      after_newest_s + kLateSMax > now && after_newest_s <= now + kSecondsPerStep;
  if (is_awaited) next.tick_utc_s = after_newest_s;
  return next;
}

void OutlookFetcher::plan_until_stopped() {
  constexpr std::int64_t kLookNs = kNanosecondsPerSecond / 2;
  Decision planned;
  std::uint64_t planned_answers = 0;
  while (!stop_.stop_requested()) {
    const Decision next = next_decision();
    std::uint64_t answers = 0;
    {
      const std::lock_guard lock(mutex_);
      answers = answers_;
    }
    if (next != planned || answers != planned_answers) plan(next);
    planned = next;
    planned_answers = answers;
    wait(kLookNs);
  }
}

void OutlookFetcher::plan(const Decision& decision) {
  OutlookDays days;
  Status status = Status::kOk;
  {
    const std::lock_guard lock(mutex_);
    days = fetch_state_.store.days_at(decision.tick_utc_s);
    status = fetch_state_.status;
  }
  planner_.plan(
      {.tick_utc_s = decision.tick_utc_s, .level_centi = decision.level_centi, .feed = status},
      days);
  publisher_.publish_outlook(exchange_);
}

/// Checks often, because the clock may be stepped.
void OutlookFetcher::fetch_until_stopped() {
  constexpr std::int64_t kLookNs = 10 * kNanosecondsPerSecond;
  while (!stop_.stop_requested()) {
    wait(kLookNs);
    const std::int64_t now = now_utc_s();
    // From here on only this thread writes the fetch state, so it reads without the lock.
    if (!fetch_state_.is_due(config_.outlook, now)) continue;
    const Status before = fetch_state_.status;
    fetch(now);
    if (fetch_state_.status != before) {
      say(fetch_state_.status == Status::kOk ? JournalLevel::kNotice : JournalLevel::kWarning,
          "outlook: day-ahead prices: " + fetch_state_.reason);
    }
  }
}

void OutlookFetcher::fetch(std::int64_t now_utc_s) {
  const DayAheadReply reply =
      ask_day_ahead(config_.outlook, now_utc_s, [this] { return stop_.stop_requested(); });
  {
    const std::lock_guard lock(mutex_);
    const bool is_new = fetch_state_.take(reply, config_.outlook, now_utc_s);
    is_kept_ = is_kept_ && !is_new;
    ++answers_;
  }
  if (is_kept_) return;
  is_kept_ = keep_day_ahead(kept_path_.c_str(), fetch_state_.store);
  if (!is_kept_) say(JournalLevel::kWarning, "outlook: " + kept_path_ + " cannot be written");
}

void OutlookFetcher::wait(std::int64_t simulated_ns) const {
  constexpr std::int64_t kLeastNs = 1'000'000;
  pause(std::max(config_.clock.wall_ns(simulated_ns), kLeastNs), stop_);
}

}  // namespace bess
