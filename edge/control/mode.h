// The controller's modes and every transition between them: a pure function, tested as a table.
//
//   start     nothing was ordered yet; waits for battery, price and clock   -> running, holding
//   running   orders follow student and guard                               -> holding, safe
//   holding   a stop reason is present: 0 W is held for a while             -> running, safe
//   safe      released: the battery is in its own mode, the loop goes on    -> running
//   stopping  the process ends: 0 W, then release                           (reached from all)
#pragma once

#include <cstdint>
#include <iterator>
#include <string_view>

namespace bess {

enum class Mode : std::uint8_t { kStart, kRunning, kHolding, kSafe, kStopping };
inline constexpr int kModeCount = static_cast<int>(Mode::kStopping) + 1;

constexpr std::string_view mode_name(Mode mode) {
  constexpr std::string_view kNames[] = {"start", "running", "holding", "safe", "stopping"};
  static_assert(std::size(kNames) == kModeCount);
  return kNames[static_cast<int>(mode)];
}

struct ModeInputs {
  bool stop_requested;
  bool stop_reason;   ///< the guard forbids driving the battery
  bool hold_elapsed;  ///< 0 W has been held for the configured time
  bool release_now;   ///< the reason is one that 0 W makes worse
  bool order_found;   ///< at start the battery was found following an order, of an earlier run
};

constexpr Mode next_mode(Mode mode, const ModeInputs& in) {
  if (in.stop_requested || mode == Mode::kStopping) return Mode::kStopping;
  if (!in.stop_reason) return Mode::kRunning;
  switch (mode) {
    case Mode::kRunning:
      return in.release_now ? Mode::kSafe : Mode::kHolding;
    case Mode::kHolding:
      return in.hold_elapsed || in.release_now ? Mode::kSafe : Mode::kHolding;
    case Mode::kStart:
      if (!in.order_found) return Mode::kStart;
      return in.release_now ? Mode::kSafe : Mode::kHolding;
    case Mode::kSafe:
    case Mode::kStopping:
      break;
  }
  return mode;
}

}  // namespace bess
