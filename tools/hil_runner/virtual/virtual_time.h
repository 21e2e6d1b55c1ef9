// Virtual time of this process. While a VirtualTime exists, the edge's calls of clock_gettime,
// clock_nanosleep, sigtimedwait and adjtimex reach it instead of the kernel (linker option --wrap,
// see virtual_time.cpp). EdgeClock, Modbus link and driver run unchanged, idle time takes no time,
// and runs are byte-identical.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "shared/scaled_clock.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

inline constexpr std::int64_t kMillisecondNs = 1'000'000;

/// Thrown in a wait of the edge, to end it like SIGKILL.
struct EdgeKilled {};

class VirtualTime {
 public:
  /// Begins at the start of the scenario. One at a time in a process.
  explicit VirtualTime(const Scenario& scenario);
  VirtualTime(const VirtualTime&) = delete;
  VirtualTime& operator=(const VirtualTime&) = delete;
  ~VirtualTime();
  /// Null: real time.
  static VirtualTime* current();

  [[nodiscard]] std::int64_t monotonic_ns() const { return now_ns_; }
  /// True time, for battery and market.
  [[nodiscard]] std::int64_t utc_ns() const { return start_utc_ns_ + now_ns_; }
  /// Time of the edge's clock, which may be stepped.
  [[nodiscard]] std::int64_t edge_utc_ns() const { return utc_ns() + step_ns_; }
  [[nodiscard]] std::int64_t edge_utc_s() const { return edge_utc_ns() / kNanosecondsPerSecond; }
  [[nodiscard]] bool is_synchronised() const { return synchronised_; }
  [[nodiscard]] bool battery_is_paused() const { return battery_is_paused_; }
  /// Listener for commands of people or other programs.
  void on_operator(std::function<void(const ScenarioEvent&)> listener) {
    on_operator_ = std::move(listener);
  }
  enum class Market : std::uint8_t { kServes, kPaused, kDead };
  [[nodiscard]] Market market() const { return market_; }

  /// Advances to an instant, or to an earlier event for the edge, and further while the edge is
  /// paused. Throws EdgeKilled.
  void advance_to(std::int64_t monotonic_ns);
  /// Takes a pending signal of the edge; 0: none.
  int take_signal();
  /// Advances to the next start of the edge; false if the scenario ends before.
  bool advance_to_next_start();

 private:
  void apply(const ScenarioEvent& event);
  [[nodiscard]] std::int64_t time_of(const ScenarioEvent& event) const;
  [[nodiscard]] bool has_event() const { return next_event_ < events_.size(); }
  [[nodiscard]] bool has_event_until(std::int64_t monotonic_ns) const;

  const Scenario& scenario_;
  std::int64_t start_utc_ns_;
  std::int64_t now_ns_;
  std::int64_t step_ns_ = 0;
  std::vector<ScenarioEvent> events_;  ///< of the scenario, plus the final stop
  std::size_t next_event_ = 0;
  int signal_ = 0;
  bool edge_runs_ = true;
  bool edge_is_paused_ = false;
  bool synchronised_ = true;
  bool battery_is_paused_ = false;
  Market market_ = Market::kServes;
  std::function<void(const ScenarioEvent&)> on_operator_ = [](const ScenarioEvent&) {};
};

}  // namespace bess
