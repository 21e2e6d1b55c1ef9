#include "edge/fetch/outlook_fetcher.h"

#include <algorithm>

#include "edge/control/level_start.h"
#include "edge/fetch/day_ahead_file.h"
#include "edge/fetch/pause.h"
#include "edge/log/journal.h"
#include "edge/log/log_reader.h"

namespace bess {
namespace {

void say(JournalLevel level, const std::string& text) {
  write_journal_line(level, "bess-prices: outlook: " + text);
}

/// The first tick at or after an instant.
std::int64_t tick_from(std::int64_t utc_s) {
  return (utc_s + kSecondsPerStep - 1) / kSecondsPerStep * kSecondsPerStep;
}

}  // namespace

OutlookFetcher::OutlookFetcher(const EdgeConfig& config, const OutlookModel& model,
                               PricePublisher& publisher, const std::stop_token& stop)
    : config_(config),
      publisher_(publisher),
      stop_(stop),
      kept_path_(state_file(config, kDayAheadFileName).view()),
      planner_(model, board_) {}

void OutlookFetcher::start(std::int32_t start_centi) {
  start_centi_ = start_centi;
  const std::int64_t now = now_utc_s();
  const int kept = restore_day_ahead(kept_path_.c_str(), inquiry_.book);
  fetch(now);
  say(JournalLevel::kNotice,
      std::to_string(kept) + " day-ahead prices kept; asked for more: " +
          std::string(day_ahead_status_text(inquiry_.status, config_.outlook)));
  const Decision decision = next_decision();
  planner_.plan_usual_day(now, decision.level_centi);
  plan(decision);
}

OutlookFetcher::Decision OutlookFetcher::next_decision() const {
  Decision next{tick_from(now_utc_s()), start_centi_};
  LogReader log;
  FileMessage ignored;
  CycleRecord newest;
  if (!log.open(config_.log, ignored) || !log.newest(newest)) return next;
  const PriceLevel level = level_from_log(newest.price_level, now_utc_s());
  if (level.is_known()) next.level_centi = level.centi_eur_per_mwh();
  // A controller that runs decides some seconds behind its tick: until then its plan stays.
  constexpr std::int64_t kLateSMax = 90;
  const std::int64_t after_newest_s = newest.utc_s + kSecondsPerStep;
  const std::int64_t now = now_utc_s();
  const bool is_awaited =
      after_newest_s + kLateSMax > now && after_newest_s <= now + kSecondsPerStep;
  if (is_awaited) next.tick_utc_s = after_newest_s;
  return next;
}

void OutlookFetcher::plan_for_ever() {
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
    days = inquiry_.book.days_at(decision.tick_utc_s);
    status = inquiry_.status;
  }
  planner_.plan(
      {.tick_utc_s = decision.tick_utc_s, .level_centi = decision.level_centi, .feed = status},
      days);
  publisher_.publish_outlook(board_);
}

/// Looks up often: the clock may be stepped.
void OutlookFetcher::fetch_for_ever() {
  constexpr std::int64_t kLookNs = 10 * kNanosecondsPerSecond;
  while (!stop_.stop_requested()) {
    wait(kLookNs);
    const std::int64_t now = now_utc_s();
    // Only this thread writes the inquiry from here on: it reads it without the lock.
    if (!inquiry_.is_due(config_.outlook, now)) continue;
    const Status before = inquiry_.status;
    fetch(now);
    if (inquiry_.status != before) {
      say(inquiry_.status == Status::kOk ? JournalLevel::kNotice : JournalLevel::kWarning,
          "day-ahead prices: " +
              std::string(day_ahead_status_text(inquiry_.status, config_.outlook)));
    }
  }
}

void OutlookFetcher::fetch(std::int64_t now_utc_s) {
  const DayAheadAsked asked =
      ask_day_ahead(config_.outlook, now_utc_s, [this] { return stop_.stop_requested(); });
  {
    const std::lock_guard lock(mutex_);
    const bool is_new = inquiry_.take(asked, config_.outlook, now_utc_s);
    is_kept_ = is_kept_ && !is_new;
    ++answers_;
  }
  if (is_kept_) return;
  is_kept_ = keep_day_ahead(kept_path_.c_str(), inquiry_.book);
  if (!is_kept_) say(JournalLevel::kWarning, kept_path_ + " cannot be written");
}

void OutlookFetcher::wait(std::int64_t simulated_ns) const {
  constexpr std::int64_t kLeastNs = 1'000'000;
  pause(std::max(config_.clock.wall_ns(simulated_ns), kLeastNs), stop_);
}

}  // namespace bess
