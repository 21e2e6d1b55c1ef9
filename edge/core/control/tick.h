// Decision grid: a tick is a multiple of 2 minutes UTC.
#pragma once

#include <cstdint>
#include <iterator>
#include <string_view>

#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"

namespace bess {

// Modes of the controller and all transitions: a pure function, tested as a table.
//
//   start     no order yet; waits for battery, price and clock          -> running, holding, safe
//   running   orders follow student and guard                               -> holding, safe
//   holding   a stop reason is present: 0 W is held for a while             -> running, safe
//   safe      released: the battery is in its own mode, the loop continues  -> running
//   stopping  the process ends: 0 W, then release                           (reached from all)
//
// Logged by value: new modes are appended.

enum class Mode : std::uint8_t { kStart, kRunning, kHolding, kSafe, kStopping };
inline constexpr int kModeCount = static_cast<int>(Mode::kStopping) + 1;

constexpr std::string_view mode_name(Mode mode) {
  constexpr std::string_view kNames[] = {"start", "running", "holding", "safe", "stopping"};
  static_assert(std::size(kNames) == kModeCount);
  return kNames[static_cast<int>(mode)];
}

struct ModeInputs {
  bool stop_requested;
  bool stop_reason;   ///< the guard does not permit driving the battery
  bool hold_elapsed;  ///< 0 W has been held for the configured time
  bool release_now;   ///< the reason is one that 0 W makes worse
  bool order_found;   ///< at start the battery followed an order of an earlier run
};

constexpr Mode next_mode(Mode mode, const ModeInputs& in) {
  if (in.stop_requested || mode == Mode::kStopping) return Mode::kStopping;
  if (!in.stop_reason) return Mode::kRunning;
  const bool has_order =
      mode == Mode::kRunning || mode == Mode::kHolding || (mode == Mode::kStart && in.order_found);
  if (!has_order) return mode;
  const bool is_held_out = mode == Mode::kHolding && in.hold_elapsed;
  return in.release_now || is_held_out ? Mode::kSafe : Mode::kHolding;
}

constexpr std::int64_t next_tick_utc_s(std::int64_t now_utc_s) {
  return (now_utc_s / kSecondsPerStep + 1) * kSecondsPerStep;
}

/// The instant in monotonic time, at most `longest_s` from now: after a clock step backwards the
/// tick is far in the future.
template <typename Clock>
std::int64_t bounded_monotonic_ns(Clock& clock, std::int64_t utc_s, std::int64_t longest_s) {
  const std::int64_t longest_ns = clock.now_utc_ns() + longest_s * kNanosecondsPerSecond;
  const std::int64_t utc_ns = utc_s * kNanosecondsPerSecond;
  return clock.monotonic_ns_at(utc_ns < longest_ns ? utc_ns : longest_ns);
}

/// UTC without clock steps since construction: for durations.
template <typename Clock>
class SteadyTime {
 public:
  explicit SteadyTime(const Clock& clock)
      : clock_(clock),
        start_utc_ns_(clock.now_utc_ns()),
        start_monotonic_ns_(clock.monotonic_ns_at(start_utc_ns_)) {}

  [[nodiscard]] std::int64_t now_s() const {
    const std::int64_t stepped_ns = start_monotonic_ns_ - clock_.monotonic_ns_at(start_utc_ns_);
    return (clock_.now_utc_ns() - stepped_ns) / kNanosecondsPerSecond + ahead_s_;
  }
  /// Must be called before `now_s`.
  void set_ahead(std::int64_t ahead_s) { ahead_s_ = ahead_s; }

 private:
  const Clock& clock_;
  std::int64_t start_utc_ns_;
  std::int64_t start_monotonic_ns_;
  std::int64_t ahead_s_ = 0;
};

}  // namespace bess
