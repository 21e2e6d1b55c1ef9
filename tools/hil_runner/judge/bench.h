// What a rule is judged by: what was asked and left behind, when something was wrong, and what the
// edge could know. Each rule is a function judge_NAME in a file of its own.
#pragma once

#include <fmt/core.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/scaled_clock.h"
#include "tools/hil_runner/evidence/evidence.h"
#include "tools/hil_runner/judge/judge.h"
#include "tools/hil_runner/scenario/rules.h"
#include "tools/simulators/battery_sim/house_load.h"

namespace bess {

inline constexpr std::int64_t kSecondNs = kNanosecondsPerSecond;
inline constexpr std::int64_t kStepNs = kSecondsPerStep * kSecondNs;

struct Window {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = INT64_MAX;
};

inline std::string watts(const CommandInForce& command) {
  return command.is_driven ? fmt::format("{:.0f} W", command.power_w) : "no order";
}

class Bench {
 public:
  /// Of the trial all must outlive this object.
  explicit Bench(const Trial& trial);

  /// Of each rule the first is kept.
  void find(std::int64_t utc_ns, std::string expected, std::string seen);
  /// In the order of time.
  std::vector<Finding> findings();

  // When.
  [[nodiscard]] std::int64_t slack_ns() const {
    return static_cast<std::int64_t>(evidence.slack_s * 1e9);
  }
  /// By then the order of a tick is settled.
  [[nodiscard]] std::int64_t settled_ns(std::int64_t tick_ns) const {
    return tick_ns + (config.control.price_wait_s + 5) * kSecondNs + slack_ns();
  }
  /// The same where the bus or a process is disturbed: requests are repeated until the order's
  /// deadline.
  [[nodiscard]] std::int64_t settled_at_worst_ns(std::int64_t tick_ns) const {
    return is_disturbed_in_cycle(tick_ns)
               ? tick_ns + config.control.order_deadline_s * kSecondNs + slack_ns()
               : settled_ns(tick_ns);
  }
  [[nodiscard]] std::int64_t start_ns() const { return scenario.utc_ns_at(0); }
  /// After the first orders, until the end.
  template <typename Visit>
  void each_tick(const Visit& visit) const {
    const std::int64_t end_ns = scenario.end_utc_ns() - kStepNs;
    for (std::int64_t t = start_ns() + 2 * kStepNs; t <= end_ns; t += kStepNs) visit(t);
  }
  /// Between a tick and the instant at which its order is looked for.
  [[nodiscard]] bool is_disturbed_in_cycle(std::int64_t tick_ns) const {
    return is_disturbed(tick_ns) || is_disturbed(settled_ns(tick_ns));
  }
  [[nodiscard]] bool is_disturbed(std::int64_t ns) const;
  [[nodiscard]] bool is_lost(std::int64_t tick_ns) const;

  // What could be known.
  /// The newest price of a tick, when it is fresh enough to be acted on.
  [[nodiscard]] std::optional<Publication::Row> fresh_row(std::int64_t tick_ns) const;
  /// Where there is no fresh one: what the newest has become may.
  [[nodiscard]] bool may_stand_in(std::int64_t tick_ns) const;
  /// By then it may count as none: from one row on or from the next, as the edge met them.
  [[nodiscard]] bool may_be_frozen(const Publication::Row& row) const;
  [[nodiscard]] bool must_be_frozen(const Publication::Row& row) const;
  [[nodiscard]] double soc_at(std::int64_t utc_ns) const;
  /// By which the SoC may pass a bound: the device's own resolution, or what flows in a cycle.
  [[nodiscard]] double soc_margin_frac() const;

  // What a site's limits may have done.
  /// Between two ticks it only cuts, but what was taken in a quarter-hour is given back for its
  /// peak.
  [[nodiscard]] bool may_be_cut(double from_w, double to_w) const;
  [[nodiscard]] bool was_cut(std::int64_t tick_ns, std::int64_t by_ns, double ordered_w) const;

  const Scenario& scenario;
  const EdgeConfig& config;
  const Evidence& evidence;
  const Publication publication;
  const CommandTimeline commands;
  const PriceLevel level;  ///< at the start
  std::optional<HouseLoad> house;
  std::vector<Window> lost;  ///< nobody can feed or end an order
  std::string rule;          ///< that is judged

 private:
  void find_disturbances();
  template <typename Add>
  void add_spans(std::vector<Window>& list, std::initializer_list<ScenarioEvent::Does> begin,
                 ScenarioEvent::Does end, const Add& add);
  [[nodiscard]] bool has_stood(const Publication::Row& row, std::int64_t for_s) const;
  [[nodiscard]] bool device_has_soc_limits() const;

  std::vector<Window> disturbed_;
  std::vector<Finding> findings_;
};

#define BESS_ROW(name, text) void judge_##name(Bench& bench);
BESS_RULES(BESS_ROW)
#undef BESS_ROW
/// What the scenario expects of its own, and how it ended.
void judge_expectations(Bench& bench);
void judge_end(Bench& bench);

}  // namespace bess
