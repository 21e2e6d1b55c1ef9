#include "edge/program/hold_watch.h"

#include <time.h>

#include <cerrno>

#include "edge/program/hold_file.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

/// False when the semaphore was posted before the time was over.
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

void HoldWatch::start(const char* path, const ClearancePaths& cleared, std::int32_t time_scale) {
  constexpr std::int64_t kPeriodNsMin = kNanosecondsPerSecond / 1'000;
  path_ = FixedText<639>(path);
  cleared_ = cleared;
  const std::int64_t period_ns = kNanosecondsPerSecond / time_scale;
  period_ns_ = period_ns > kPeriodNsMin ? period_ns : kPeriodNsMin;
  look();
  thread_.start(
      [](void* watch) -> void* {
        static_cast<HoldWatch*>(watch)->run();
        return nullptr;
      },
      this);
}

void HoldWatch::run() {
  while (wait_ns(ending_, period_ns_)) look();
}

void HoldWatch::look() {
  mailbox_.publish(read_hold(path_.c_str()));
  const std::int64_t trip_utc_s = asked_trip_utc_s_;
  if (trip_utc_s == 0 || cleared_trip_utc_s_ == trip_utc_s) return;
  if (is_trip_cleared(cleared_, trip_utc_s)) cleared_trip_utc_s_ = trip_utc_s;
}

bool HoldWatch::is_cleared(std::int64_t trip_utc_s) {
  asked_trip_utc_s_ = trip_utc_s;
  return trip_utc_s != 0 && cleared_trip_utc_s_ == trip_utc_s;
}

}  // namespace bess
