// Time that this process makes itself. While a VirtualTime lives, the edge's calls of
// clock_gettime, clock_nanosleep, sigtimedwait and adjtimex reach it instead of the kernel (the
// linker's --wrap, see virtual_time.cpp): EdgeClock, the Modbus link and the driver run as they
// are, an hour passes as soon as nobody has anything to do in it, and a run repeats to the byte.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

inline constexpr std::int64_t kMillisecondNs = 1'000'000;

/// Ends the edge where it stands, as SIGKILL does: thrown out of whatever it waits for.
struct EdgeKilled {};

class VirtualTime {
 public:
  /// Time stands at the scenario's start. One at a time in a process.
  explicit VirtualTime(const Scenario& scenario);
  VirtualTime(const VirtualTime&) = delete;
  VirtualTime& operator=(const VirtualTime&) = delete;
  ~VirtualTime();
  /// Null: this process lives in real time.
  static VirtualTime* current();

  [[nodiscard]] std::int64_t monotonic_ns() const { return now_ns_; }
  /// The true one, in which battery and market live.
  [[nodiscard]] std::int64_t utc_ns() const { return start_utc_ns_ + now_ns_; }
  /// What the edge's clock shows: it may be stepped.
  [[nodiscard]] std::int64_t edge_utc_ns() const { return utc_ns() + step_ns_; }
  [[nodiscard]] bool is_synchronised() const { return synchronised_; }
  [[nodiscard]] bool battery_is_paused() const { return battery_is_paused_; }
  /// Who is told when people, or another program, say something to the edge.
  void on_people(std::function<void(const ScenarioEvent&)> listener) {
    on_people_ = std::move(listener);
  }
  enum class Market : std::uint8_t { kServes, kPaused, kDead };
  [[nodiscard]] Market market() const { return market_; }

  /// Lets time pass to an instant, or to the first event that the edge has to see before it, and
  /// further while the edge is paused. Throws EdgeKilled.
  void advance_to(std::int64_t monotonic_ns);
  /// A signal that waits for the edge, taken; 0 = none.
  int take_signal();
  /// Lets time pass until somebody starts the edge again; false when the scenario ends before.
  bool advance_to_next_start();

 private:
  void apply(const ScenarioEvent& event);
  [[nodiscard]] std::int64_t time_of(const ScenarioEvent& event) const;
  [[nodiscard]] bool has_event_until(std::int64_t monotonic_ns) const;

  const Scenario& scenario_;
  std::int64_t start_utc_ns_;
  std::int64_t now_ns_;
  std::int64_t base_ns_;  ///< of now_ns_ at the start
  std::int64_t step_ns_ = 0;
  std::vector<ScenarioEvent> events_;  ///< of the scenario, and the stop at its end
  std::size_t next_event_ = 0;
  std::int64_t next_event_ns_ = 0;  ///< INT64_MAX: there is none
  int signal_ = 0;
  bool edge_runs_ = true;
  bool edge_is_paused_ = false;
  bool synchronised_ = true;
  bool battery_is_paused_ = false;
  Market market_ = Market::kServes;
  std::function<void(const ScenarioEvent&)> on_people_ = [](const ScenarioEvent&) {};
};

}  // namespace bess
