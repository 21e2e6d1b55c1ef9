#include "tools/hil_runner/virtual/virtual_outlook.h"

#include "edge/fetch/day_ahead_feed.h"
#include "shared/scaled_clock.h"
#include "tools/hil_runner/scenario/day_ahead.h"

namespace bess {

VirtualOutlook::VirtualOutlook(const Scenario& scenario, const OutlookSettings& settings,
                               const OutlookModel& model, VirtualTime& time)
    : settings_(settings),
      model_(model),
      time_(time),
      auction_(day_ahead_rows(scenario), scenario.day_ahead.value_or(AuctionSettings{})) {}

OutlookBoard* VirtualOutlook::start(std::int32_t level_centi) {
  process_ = std::make_unique<Process>(model_);
  process_->inquiry.book = kept_;
  const std::int64_t now = edge_utc_s();
  fetch(now);
  process_->planner.plan_usual_day(now, level_centi);
  plan((now + kSecondsPerStep - 1) / kSecondsPerStep * kSecondsPerStep, level_centi);
  return &process_->board;
}

void VirtualOutlook::cycle_done(const CycleRecord& record) {
  const std::int64_t now = edge_utc_s();
  if (process_->inquiry.is_due(settings_, now)) fetch(now);
  plan(record.utc_s + kSecondsPerStep, record.price_level.centi_eur_per_mwh());
}

void VirtualOutlook::fetch(std::int64_t now_utc_s) {
  DayAheadInquiry& inquiry = process_->inquiry;
  if (inquiry.take(ask(now_utc_s), settings_, now_utc_s)) kept_ = inquiry.book;
}

/// The server answers by the true time, and is asked for the days of the edge's.
DayAheadAsked VirtualOutlook::ask(std::int64_t now_utc_s) const {
  if (time_.market() == VirtualTime::Market::kPaused) return {.status = Status::kTimeout};
  if (time_.market() == VirtualTime::Market::kDead) return {.status = Status::kNotConnected};
  const OutlookDays days = outlook_days_around(now_utc_s);
  const AuctionAnswer answer =
      auction_.answer(std::string(day_ahead_url("{today}", days).view()),
                      std::string(day_ahead_url("{tomorrow}", days).view()),
                      time_.utc_ns() / kNanosecondsPerSecond);
  if (answer.fault == AuctionFault::kSlow) return {.status = Status::kTimeout};
  if (answer.status != 200) return {.status = Status::kHttpError};
  return read_day_ahead(answer.body, settings_.fields);
}

void VirtualOutlook::plan(std::int64_t tick_utc_s, std::int32_t level_centi) {
  process_->planner.plan(
      {.tick_utc_s = tick_utc_s, .level_centi = level_centi, .feed = process_->inquiry.status},
      process_->inquiry.book.days_at(tick_utc_s));
}

std::int64_t VirtualOutlook::edge_utc_s() const {
  return time_.edge_utc_ns() / kNanosecondsPerSecond;
}

}  // namespace bess
