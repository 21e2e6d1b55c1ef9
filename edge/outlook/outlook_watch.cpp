#include "edge/outlook/outlook_watch.h"

#include <sys/resource.h>

#include <algorithm>
#include <cerrno>

#include "edge/log/journal.h"
#include "edge/memory/timed_wait.h"
#include "edge/outlook/day_ahead_file.h"

namespace bess {
namespace {

constexpr int kNicerThanControl = 5;

std::uint64_t word_of(std::int64_t tick_utc_s, std::int32_t level_centi) {
  return static_cast<std::uint64_t>(tick_utc_s / kSecondsPerStep) << 32 |
         static_cast<std::uint32_t>(level_centi);
}

/// The first tick at or after an instant.
std::int64_t tick_from(std::int64_t utc_s) {
  return (utc_s + kSecondsPerStep - 1) / kSecondsPerStep * kSecondsPerStep;
}

}  // namespace

OutlookWatch::OutlookWatch(const OutlookSettings& settings, const OutlookModel& model,
                           const ScaledClock& clock, std::string_view kept_path)
    : settings_(settings),
      clock_(clock),
      kept_path_(kept_path),
      feed_(settings),
      planner_(model, board_) {
  sem_init(&ending_, 0, 0);
  sem_init(&to_plan_, 0, 0);
}

OutlookWatch::~OutlookWatch() {
  is_ending_ = true;
  sem_post(&ending_);
  sem_post(&to_plan_);
  if (feed_thread_.is_running()) feed_thread_.join();
  if (plan_thread_.is_running()) plan_thread_.join();
  sem_destroy(&ending_);
  sem_destroy(&to_plan_);
}

void OutlookWatch::start(std::int32_t level_centi) {
  const std::int64_t now = now_utc_s();
  const int kept = restore_day_ahead(kept_path_.c_str(), inquiry_.book);
  fetch(now);
  report(JournalLevel::kNotice, "outlook: %d day-ahead prices kept; asked for more: %s", kept,
         day_ahead_status_text(inquiry_.status, settings_).data());
  planner_.plan_usual_day(now, level_centi);
  plan(tick_from(now), level_centi);
  feed_thread_.start(
      [](void* watch) -> void* {
        static_cast<OutlookWatch*>(watch)->fetch_for_ever();
        return nullptr;
      },
      this);
  plan_thread_.start(
      [](void* watch) -> void* {
        static_cast<OutlookWatch*>(watch)->plan_for_ever();
        return nullptr;
      },
      this);
}

std::int64_t OutlookWatch::now_utc_s() const {
  const std::int64_t now = clock_.now_utc_ns() / kNanosecondsPerSecond;
  return clock_.is_real_time() ? now : std::max(now, clock_.anchor_utc_s);
}

void OutlookWatch::plan_after(std::int64_t tick_utc_s, std::int32_t level_centi) {
  wanted_.store(word_of(tick_utc_s + kSecondsPerStep, level_centi), std::memory_order_relaxed);
  sem_post(&to_plan_);
}

void OutlookWatch::plan_for_ever() {
  // Where it is not permitted, the kernel shares the processor evenly.
  static_cast<void>(setpriority(PRIO_PROCESS, 0, kNicerThanControl));
  while (true) {
    while (sem_wait(&to_plan_) != 0 && errno == EINTR) continue;
    while (sem_trywait(&to_plan_) == 0) continue;  // one plan answers them all
    if (is_ending_) return;
    const std::uint64_t wanted = wanted_.load(std::memory_order_relaxed);
    if (wanted == 0) continue;
    plan(static_cast<std::int64_t>(wanted >> 32) * kSecondsPerStep,
         static_cast<std::int32_t>(static_cast<std::uint32_t>(wanted)));
  }
}

void OutlookWatch::plan(std::int64_t tick_utc_s, std::int32_t level_centi) {
  OutlookDays days;
  Status status = Status::kOk;
  {
    const std::lock_guard lock(mutex_);
    days = inquiry_.book.days_at(tick_utc_s);
    status = inquiry_.status;
  }
  planner_.plan({.tick_utc_s = tick_utc_s, .level_centi = level_centi, .feed = status}, days);
}

/// Looks up often: the clock may be stepped.
void OutlookWatch::fetch_for_ever() {
  constexpr std::int64_t kLookEveryS = 10, kLookNsMin = 1'000'000;
  const std::int64_t look_ns =
      std::max(clock_.wall_ns(kLookEveryS * kNanosecondsPerSecond), kLookNsMin);
  while (wait_ns(ending_, look_ns)) {
    const std::int64_t now = now_utc_s();
    // Only this thread writes the inquiry from here on: it reads it without the lock.
    if (!inquiry_.is_due(settings_, now)) continue;
    const Status before = inquiry_.status;
    fetch(now);
    if (inquiry_.status != before) {
      report(inquiry_.status == Status::kOk ? JournalLevel::kNotice : JournalLevel::kWarning,
             "outlook: day-ahead prices: %s",
             day_ahead_status_text(inquiry_.status, settings_).data());
    }
    sem_post(&to_plan_);
  }
}

void OutlookWatch::fetch(std::int64_t now) {
  const Status asked = feed_.ask(now);
  {
    const std::lock_guard lock(mutex_);
    const bool is_new = inquiry_.take(asked, feed_.rows(), settings_, now);
    is_kept_ = is_kept_ && !is_new;
  }
  if (is_kept_) return;
  is_kept_ = keep_day_ahead(kept_path_.c_str(), inquiry_.book);
  if (!is_kept_) {
    report(JournalLevel::kWarning, "outlook: %s cannot be written", kept_path_.c_str());
  }
}

}  // namespace bess
