// Clock of the control thread: UTC (possibly scaled), absolute deadlines, and stop requests.
// SIGTERM, SIGINT and SIGHUP are blocked in every thread and received synchronously while waiting,
// so no signal is lost between a test and a sleep, and no handler interrupts an order.
#pragma once

#include <pthread.h>
#include <signal.h>
#include <sys/timex.h>
#include <time.h>

#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"

namespace bess {

class EdgeClock {
 public:
  /// Construct before any thread starts: threads inherit the blocked signals.
  explicit EdgeClock(const ScaledClock& clock) : clock_(clock) {
    sigemptyset(&stop_signals_);
    sigaddset(&stop_signals_, SIGTERM);
    sigaddset(&stop_signals_, SIGINT);
    sigaddset(&stop_signals_, SIGHUP);
    pthread_sigmask(SIG_BLOCK, &stop_signals_, nullptr);
  }

  [[nodiscard]] std::int64_t now_utc_ns() const { return clock_.now_utc_ns(); }
  [[nodiscard]] std::int64_t monotonic_ns() const { return clock_ns(CLOCK_MONOTONIC); }
  [[nodiscard]] std::int64_t monotonic_ns_at(std::int64_t utc_ns) const {
    return clock_.monotonic_ns_at(utc_ns);
  }
  [[nodiscard]] const ScaledClock& scaled() const { return clock_; }

  /// Waits for a time; false after a stop request. The clock is read every second, because it may
  /// be stepped. If it is stepped back, the wait ends and the caller reads the new time.
  bool sleep_until_utc_ns(std::int64_t utc_ns) {
    constexpr std::int64_t kPollNs = 5 * kNanosecondsPerSecond;
    std::int64_t left_before_ns = INT64_MAX - kPollNs;
    while (!stop_requested()) {
      const std::int64_t left_ns = monotonic_ns_at(utc_ns) - monotonic_ns();
      if (left_ns <= 0 || left_ns > left_before_ns + kPollNs) return true;
      left_before_ns = left_ns;
      take_stop_signal(left_ns < kNanosecondsPerSecond ? left_ns : kNanosecondsPerSecond);
    }
    return false;
  }

  /// Waits also after a stop request: between attempts to release the battery.
  void pause_ns(std::int64_t ns) const {
    const std::int64_t end_ns = monotonic_ns() + clock_.wall_ns(ns);
    while (monotonic_ns() < end_ns) sleep_until_monotonic(end_ns);
  }

  /// Simulated time begins at its anchor, so that the first tick is the same in every run.
  bool wait_for_simulated_start() {
    if (clock_.is_real_time()) return true;
    const std::int64_t before_first_tick_s = clock_.anchor_utc_s - kSecondsPerStep + 1;
    return sleep_until_utc_ns(before_first_tick_s * kNanosecondsPerSecond);
  }

  bool stop_requested() {
    if (!stop_requested_) take_stop_signal(0);
    return stop_requested_;
  }

  /// Stop by SIGHUP: the process ends and leaves its order in force for the next start.
  [[nodiscard]] bool hand_over_requested() {
    take_stop_signal(0);  // SIGTERM has precedence
    return hand_over_requested_;
  }

  /// True in simulated time; real time must be set by NTP.
  [[nodiscard]] bool is_synchronised() const {
    if (!clock_.is_real_time()) return true;
    timex state{};
    const int clock_state = adjtimex(&state);  // -1: forbidden by a sandbox, unknown
    return clock_state >= 0 && clock_state != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
  }

 private:
  void take_stop_signal(std::int64_t wait_ns) {
    const timespec timeout{.tv_sec = static_cast<time_t>(wait_ns / kNanosecondsPerSecond),
                           .tv_nsec = static_cast<long>(wait_ns % kNanosecondsPerSecond)};
    const int signal = sigtimedwait(&stop_signals_, nullptr, &timeout);
    if (signal <= 0) return;
    hand_over_requested_ = signal == SIGHUP && (hand_over_requested_ || !stop_requested_);
    stop_requested_ = true;
  }

  ScaledClock clock_;
  sigset_t stop_signals_{};
  bool stop_requested_ = false;
  bool hand_over_requested_ = false;
};

}  // namespace bess
