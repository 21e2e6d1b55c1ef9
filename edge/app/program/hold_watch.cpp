#include "edge/app/program/hold_watch.h"

#include <time.h>

#include <cerrno>

#include "edge/records/log/journal.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

/// By the monotonic clock; false if the semaphore was posted earlier.
bool wait_ns(sem_t& semaphore, std::int64_t ns) {
  const std::int64_t until_ns = clock_ns(CLOCK_MONOTONIC) + ns;
  const timespec until{.tv_sec = static_cast<time_t>(until_ns / kNanosecondsPerSecond),
                       .tv_nsec = static_cast<long>(until_ns % kNanosecondsPerSecond)};
  int result = 0;
  do result = sem_clockwait(&semaphore, CLOCK_MONOTONIC, &until);
  while (result != 0 && errno == EINTR);
  return result != 0;
}

}  // namespace

HoldWatch::HoldWatch() { sem_init(&ending_, 0, 0); }

HoldWatch::~HoldWatch() {
  if (thread_.is_running()) {
    sem_post(&ending_);
    thread_.join();
  }
  sem_destroy(&ending_);
}

void HoldWatch::start(const StateFilePaths& paths, const StateFilePaths& cleared,
                      std::int32_t time_scale) {
  constexpr std::int64_t kPeriodNsMin = kNanosecondsPerSecond / 1'000;
  paths_ = paths;
  cleared_ = cleared;
  const std::int64_t period_ns = kNanosecondsPerSecond / time_scale;
  period_ns_ = period_ns > kPeriodNsMin ? period_ns : kPeriodNsMin;
  look();
  thread_.start<&HoldWatch::run>(this);
}

void HoldWatch::run() {
  while (wait_ns(ending_, period_ns_)) look();
}

void HoldWatch::look() {
  const HoldReading reading = read_newest_hold(paths_);
  latest_hold_.publish(reading.hold);
  report_losses(reading);
  const std::int64_t trip_utc_s = asked_trip_utc_s_;
  if (trip_utc_s == 0 || cleared_trip_utc_s_ == trip_utc_s) return;
  if (is_trip_cleared(cleared_, trip_utc_s)) cleared_trip_utc_s_ = trip_utc_s;
}

/// Reports each loss once. Without any readable file, the control cycle reports it.
void HoldWatch::report_losses(const HoldReading& reading) {
  const bool state_is_new = reading.state_is_lost && !reported_.state_is_lost;
  const bool run_is_new = reading.run_is_lost && !reported_.run_is_lost;
  reported_ = reading;
  if (!state_is_new && !run_is_new) return;
  report(JournalLevel::kError, "hold: %s is malformed; %s is used",
         state_is_new ? paths_.state.c_str() : paths_.run.c_str(),
         state_is_new ? paths_.run.c_str() : paths_.state.c_str());
}

bool HoldWatch::is_cleared(std::int64_t trip_utc_s) {
  asked_trip_utc_s_ = trip_utc_s;
  return trip_utc_s != 0 && cleared_trip_utc_s_ == trip_utc_s;
}

}  // namespace bess
