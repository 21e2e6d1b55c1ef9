// Waiting on a semaphore for a time, whatever becomes of the wall clock: how threads that look from
// time to time sleep, and are woken to end.
#pragma once

#include <semaphore.h>
#include <time.h>

#include <cerrno>
#include <cstdint>

#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"

namespace bess {

/// False when the semaphore was posted before the time was over.
inline bool wait_ns(sem_t& semaphore, std::int64_t ns) {
  const std::int64_t until_ns = clock_ns(CLOCK_MONOTONIC) + ns;
  const timespec until{.tv_sec = static_cast<time_t>(until_ns / kNanosecondsPerSecond),
                       .tv_nsec = static_cast<long>(until_ns % kNanosecondsPerSecond)};
  int result = 0;
  do result = sem_clockwait(&semaphore, CLOCK_MONOTONIC, &until);
  while (result != 0 && errno == EINTR);
  return result != 0;
}

}  // namespace bess
