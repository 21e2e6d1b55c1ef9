// Judge context: inputs and evidence of a run, its disturbances, and the data available to the
// edge. Each rule is a function judge_NAME in its own file.
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

struct CommandInForce {
  bool is_driven = false;  ///< follows an order; else its own mode
  double power_w = 0;
};

inline std::string watts(const CommandInForce& command) {
  return command.is_driven ? fmt::format("{:.0f} W", command.power_w) : "no order";
}

class JudgeContext : public JudgedRun {
 public:
  /// All members of `judged_run` must outlive this object.
  explicit JudgeContext(const JudgedRun& judged_run);

  /// Keeps the first finding of each rule.
  void find(std::int64_t utc_ns, std::string expected, std::string seen);
  /// Ascending in time.
  std::vector<Finding> findings();

  // Times.
  [[nodiscard]] std::int64_t slack_ns() const {
    return static_cast<std::int64_t>(evidence.slack_s * 1e9);
  }
  /// Time by which the order of a tick must be in force.
  [[nodiscard]] std::int64_t settled_ns(std::int64_t tick_ns) const {
    return tick_ns + (config.control.price_wait_s + 5) * kSecondNs + slack_ns();
  }
  /// The same with a disturbed bus or process: requests are repeated until the order deadline.
  [[nodiscard]] std::int64_t settled_at_worst_ns(std::int64_t tick_ns) const {
    return is_disturbed_in_cycle(tick_ns)
               ? tick_ns + config.control.order_deadline_s * kSecondNs + slack_ns()
               : settled_ns(tick_ns);
  }
  [[nodiscard]] std::int64_t start_ns() const { return scenario.utc_ns_at(0); }
  /// All ticks after the first orders, until the end.
  template <typename Visit>
  void each_tick(const Visit& visit) const {
    const std::int64_t end_ns = scenario.end_utc_ns() - kStepNs;
    for (std::int64_t t = start_ns() + 2 * kStepNs; t <= end_ns; t += kStepNs) visit(t);
  }
  /// Disturbance at a tick or at the time of its check.
  [[nodiscard]] bool is_disturbed_in_cycle(std::int64_t tick_ns) const {
    return is_disturbed(tick_ns) || is_disturbed(settled_ns(tick_ns));
  }
  [[nodiscard]] bool is_disturbed(std::int64_t ns) const;
  [[nodiscard]] bool is_lost(std::int64_t tick_ns) const;

  // Data available to the edge.
  /// Newest price at a tick, if it is fresh enough.
  [[nodiscard]] std::optional<Publication::Row> fresh_row(std::int64_t tick_ns) const;
  /// Without a fresh price: whether a stand-in price is allowed.
  [[nodiscard]] bool may_stand_in(std::int64_t tick_ns) const;
  /// Whether the edge may, or must, treat the price as frozen; they differ by the rows it fetched.
  [[nodiscard]] bool may_be_frozen(const Publication::Row& row) const { return has_stood(row, 0); }
  [[nodiscard]] bool must_be_frozen(const Publication::Row& row) const {
    return has_stood(row, 2 * kSecondsPerStep);
  }
  [[nodiscard]] double soc_at(std::int64_t utc_ns) const;
  /// From the battery trace.
  [[nodiscard]] CommandInForce command_at(std::int64_t utc_ns) const;
  /// Tolerance of SoC limits: resolution of the device, or the energy of one control cycle.
  [[nodiscard]] double soc_margin_frac() const;

  // Effects of limits at the connection.
  /// Limits only reduce power between two ticks, except discharging for the quarter-hour peak.
  [[nodiscard]] bool may_be_cut(double from_w, double to_w) const;
  [[nodiscard]] bool was_cut(std::int64_t tick_ns, std::int64_t by_ns, double ordered_w) const;

  const Publication publication;
  const PriceLevel level;  ///< at the start
  std::optional<HouseLoad> house;
  std::vector<Window> lost;  ///< no process can refresh or end an order
  std::string rule;          ///< rule being judged

 private:
  void find_disturbances();
  /// `is_loss`: no process can refresh or end an order.
  void add_disturbance(const Window& span, bool is_loss);
  void add_spans(std::initializer_list<ScenarioEvent::EventKind> begin,
                 ScenarioEvent::EventKind end, bool is_loss);
  /// Whether the price has stood still for the limit of the edge and longer.
  [[nodiscard]] bool has_stood(const Publication::Row& row, std::int64_t longer_s) const;
  [[nodiscard]] bool device_has_soc_limits() const;

  std::vector<Window> disturbed_;
  std::vector<Finding> findings_;
};

#define BESS_ROW(name, text) void judge_##name(JudgeContext& judging);
BESS_RULES(BESS_ROW)
#undef BESS_ROW
/// Expectations of the scenario, and its end.
void judge_expectations(JudgeContext& judging);
void judge_end(JudgeContext& judging);

}  // namespace bess
