// Link state of the battery's connection: a pure state machine over CLOCK_MONOTONIC instants.
//
//   disconnected --connected--> connected --answered--> connected      next request after the gap
//        |  ^                     |   |
//        |  +-------- lost -------+   +--no answer (RTU)--> draining --drained--> connected
//        +--connect failed--> backing off --pause over--> disconnected
//
//   disconnected  the next request connects            backing off  requests fail without trying
//   connected     the next request may go at ready_ns  draining     RTU: a late reply may come
// The pause after a failed connect doubles from 1 s to 60 s until a reply: a dead battery is not
// flooded, and each control cycle of 120 s tries at least once.
#pragma once

#include <algorithm>
#include <cstdint>

#include "shared/units_and_limits.h"

namespace bess {

inline constexpr int kBackOffFirstS = 1;
inline constexpr int kBackOffMaxS = 60;
static_assert(kBackOffMaxS < kSecondsPerStep, "every cycle tries to connect at least once");

enum class LinkState : std::uint8_t { kDisconnected, kBackingOff, kConnected, kDraining };

/// Wall nanoseconds.
struct LinkPauses {
  std::int64_t back_off_first_ns = 0;
  std::int64_t back_off_max_ns = 0;
  std::int64_t connect_delay_ns = 0;  ///< from the connect to the first request
  std::int64_t gap_ns = 0;            ///< from the end of a request to the next
  std::int64_t quiet_ns = 0;          ///< RTU: silence after a failed request
};

class LinkStateMachine {
 public:
  explicit LinkStateMachine(const LinkPauses& pauses)
      : pauses_(pauses), back_off_ns_(pauses.back_off_first_ns) {}

  [[nodiscard]] LinkState state(std::int64_t now_ns) const {
    const bool pause_over = state_ == LinkState::kBackingOff && now_ns >= retry_ns_;
    return pause_over ? LinkState::kDisconnected : state_;
  }
  /// Earliest instant of the next request, or of the end of draining.
  [[nodiscard]] std::int64_t ready_ns() const { return ready_ns_; }

  void on_connected(std::int64_t now_ns) {
    state_ = LinkState::kConnected;
    ready_ns_ = std::max(ready_ns_, now_ns + pauses_.connect_delay_ns);
  }
  void on_connect_failed(std::int64_t now_ns) {
    state_ = LinkState::kBackingOff;
    retry_ns_ = now_ns + back_off_ns_;
    back_off_ns_ = std::min(2 * back_off_ns_, pauses_.back_off_max_ns);
  }
  void on_answered(std::int64_t now_ns) {
    back_off_ns_ = pauses_.back_off_first_ns;
    ready_ns_ = now_ns + pauses_.gap_ns;
  }
  void on_no_answer(std::int64_t now_ns) {
    state_ = LinkState::kDraining;
    ready_ns_ = now_ns + std::max(pauses_.gap_ns, pauses_.quiet_ns);
  }
  void on_drained() { state_ = LinkState::kConnected; }
  /// The connection was lost or abandoned; the device's gap applies to the next one too.
  void on_lost(std::int64_t now_ns) {
    if (state_ == LinkState::kBackingOff) return;  // no connection: the pause continues
    state_ = LinkState::kDisconnected;
    ready_ns_ = now_ns + pauses_.gap_ns;
  }

 private:
  LinkPauses pauses_;
  LinkState state_ = LinkState::kDisconnected;
  std::int64_t back_off_ns_;
  std::int64_t retry_ns_ = 0;
  std::int64_t ready_ns_ = 0;
};

}  // namespace bess
