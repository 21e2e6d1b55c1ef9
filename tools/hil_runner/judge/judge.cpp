#include "tools/hil_runner/judge/judge.h"

#include <fmt/core.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "edge/control/policy.h"
#include "edge/control/quarter_hour_energy.h"
#include "shared/features.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"
#include "tools/hil_runner/evidence/command_timeline.h"
#include "tools/hil_runner/scenario/edge_settings.h"
#include "tools/hil_runner/scenario/rules.h"
#include "tools/hil_runner/scenario/scenario.h"
#include "tools/hil_runner/scenario/scenario_house.h"

namespace bess {
namespace {

constexpr std::int64_t kSecondNs = kNanosecondsPerSecond;
constexpr std::int64_t kStepNs = kSecondsPerStep * kSecondNs;

struct Window {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = INT64_MAX;
};

std::string watts(const CommandInForce& command) {
  return command.is_driven ? fmt::format("{:.0f} W", command.power_w) : "no order";
}

class Judge {
 public:
  struct Rule {
    const char* name;
    void (Judge::*judge)();
  };
  static const Rule kRules[std::size(kRuleInfos)];

  explicit Judge(const Trial& trial)
      : scenario_(trial.scenario),
        config_(trial.config),
        evidence_(trial.evidence),
        publication_(trial.scenario, trial.prices),
        commands_(trial.evidence.orders),
        level_(level_at_start(trial)) {
    if (trial.scenario.house.exists()) house_.emplace(house_load(trial.scenario));
    find_disturbances();
  }

  std::vector<Finding> run() {
    for (const Rule& rule : kRules) {
      const auto& judged = scenario_.invariants;
      if (std::ranges::find(judged, rule.name) == judged.end()) continue;
      rule_ = rule.name;
      (this->*rule.judge)();
    }
    judge_expectations();
    judge_end();
    std::ranges::stable_sort(findings_, {}, &Finding::utc_s);
    return std::move(findings_);
  }

 private:
  static PriceLevel level_at_start(const Trial& trial) {
    // By what the market has published when the edge starts, a minute before the scenario does.
    if (const int hours = trial.scenario.prices.history_hours; hours > 0) {
      return level_before(trial.prices, trial.scenario.start_utc_s - 60, hours);
    }
    const auto& setting = trial.config.level_start_centi_eur_per_mwh;
    return setting ? PriceLevel::starting_at(*setting) : PriceLevel{};
  }

  // --- when -------------------------------------------------------------------------------------
  [[nodiscard]] std::int64_t slack_ns() const {
    return static_cast<std::int64_t>(evidence_.slack_s * 1e9);
  }
  /// By then the order of a tick is settled.
  [[nodiscard]] std::int64_t settled_ns(std::int64_t tick_ns) const {
    return tick_ns + (config_.control.price_wait_s + 5) * kSecondNs + slack_ns();
  }
  /// The same where the bus or a process is disturbed: requests are repeated until the order's deadline.
  [[nodiscard]] std::int64_t settled_at_worst_ns(std::int64_t tick_ns) const {
    return is_disturbed_in_cycle(tick_ns)
               ? tick_ns + config_.control.order_deadline_s * kSecondNs + slack_ns()
               : settled_ns(tick_ns);
  }
  [[nodiscard]] std::int64_t start_ns() const { return scenario_.utc_ns_at(0); }
  /// After the first orders, until the end.
  template <typename Visit>
  void each_tick(const Visit& visit) const {
    const std::int64_t end_ns = scenario_.end_utc_ns() - kStepNs;
    for (std::int64_t t = start_ns() + 2 * kStepNs; t <= end_ns; t += kStepNs) visit(t);
  }

  /// Spans in which battery, link or process are not as they should be, and until they must be again.
  void find_disturbances() {
    const auto recovery_ns = static_cast<std::int64_t>(scenario_.recovery_min * 60e9);
    const BatteryFaultWindow& fault = scenario_.battery_fault;
    const auto add = [&](std::vector<Window>& list, std::int64_t from_ns, std::int64_t to_ns) {
      list.push_back({from_ns, to_ns});
      disturbed_.push_back({from_ns, to_ns == INT64_MAX ? to_ns : to_ns + recovery_ns});
    };
    if (!fault.schedule.faults.empty()) {
      const Window span{scenario_.utc_ns_at(fault.schedule.from_s / 60),
                        fault.schedule.to_s == kNeverMin
                            ? INT64_MAX
                            : scenario_.utc_ns_at(fault.schedule.to_s / 60)};
      std::vector<Window> other;
      const bool is_silent = fault.strikes_always() &&
                             std::ranges::all_of(fault.schedule.faults, [](BatteryFault kind) {
                               return kind == BatteryFault::kSilence ||
                                      kind == BatteryFault::kDrop || kind == BatteryFault::kReset ||
                                      kind == BatteryFault::kHalfOpen;
                             });
      add(is_silent ? lost_ : other, span.from_ns, span.to_ns);
    }
    using enum ScenarioEvent::Does;
    add_spans(lost_, {kEdgeKill, kEdgeStop, kEdgeHandOver}, kEdgeStart, add);
    add_spans(lost_, {kEdgePause}, kEdgeContinue, add);
    add_spans(lost_, {kBatteryPause}, kBatteryContinue, add);
    std::vector<Window> clocks;
    add_spans(clocks, {kClockUnsynchronised}, kClockSynchronised, add);
    add_spans(clocks, {kClockStep}, kClockStep, add);
  }

  template <typename Add>
  void add_spans(std::vector<Window>& list, std::initializer_list<ScenarioEvent::Does> begin,
                 ScenarioEvent::Does end, const Add& add) {
    std::int64_t from_ns = -1;
    for (const ScenarioEvent& event : scenario_.events) {
      const std::int64_t at_ns = scenario_.utc_ns_at(event.at_min);
      const bool begins = std::ranges::find(begin, event.does) != begin.end();
      if (event.does == end && from_ns >= 0) {
        add(list, from_ns, at_ns);
        from_ns = -1;
      } else if (begins && from_ns < 0) {
        from_ns = at_ns;
      }
    }
    if (from_ns >= 0) add(list, from_ns, INT64_MAX);
  }

  /// Between a tick and the instant at which its order is looked for.
  [[nodiscard]] bool is_disturbed_in_cycle(std::int64_t tick_ns) const {
    return is_disturbed(tick_ns) || is_disturbed(settled_ns(tick_ns));
  }
  [[nodiscard]] bool is_disturbed(std::int64_t ns) const {
    return std::ranges::any_of(
        disturbed_, [&](const Window& w) { return ns >= w.from_ns - slack_ns() && ns < w.to_ns; });
  }

  // --- what could be known ------------------------------------------------------------------------
  /// The newest price of a tick, when it is fresh enough to be acted on.
  [[nodiscard]] std::optional<Publication::Row> fresh_row(std::int64_t tick_ns) const {
    const auto row = publication_.newest(tick_ns + config_.control.price_wait_s * kSecondNs);
    if (!row) return std::nullopt;
    const std::int64_t tick_utc_s = tick_ns / kSecondNs;
    const bool is_fresh =
        price_age_s(tick_utc_s, row->minute_utc_s) <= config_.control.guard.price_age_s_max &&
        quarter_hour_of(tick_utc_s) - quarter_hour_of(row->minute_utc_s) <= 1;
    return is_fresh ? row : std::nullopt;
  }
  /// That its price was the only one for so long before it, as far as the edge can have seen.
  [[nodiscard]] bool has_stood(const Publication::Row& row, std::int64_t for_s) const {
    const std::int64_t first_utc_s = row.minute_utc_s - for_s;
    if (first_utc_s < scenario_.start_utc_s - 60) return false;
    for (std::int64_t utc_s = first_utc_s; utc_s < row.minute_utc_s; utc_s += 60) {
      const auto price = publication_.price_of(utc_s);
      if (price && *price != row.eur_per_mwh) return false;
    }
    return true;
  }
  /// By then it may count as none: from one row on or from the next, as the edge met them.
  [[nodiscard]] bool may_be_frozen(const Publication::Row& row) const {
    const std::int32_t stop_s = config_.control.frozen_price.stop_s;
    return stop_s > 0 && has_stood(row, stop_s);
  }
  [[nodiscard]] bool must_be_frozen(const Publication::Row& row) const {
    const std::int32_t stop_s = config_.control.frozen_price.stop_s;
    return stop_s > 0 && has_stood(row, stop_s + 2 * kSecondsPerStep);
  }
  [[nodiscard]] double soc_at(std::int64_t utc_ns) const {
    const std::int64_t minute_utc_s = utc_ns / kSecondNs / 60 * 60;
    const auto& minutes = evidence_.minutes;
    auto next = std::ranges::lower_bound(minutes, minute_utc_s, {}, &MinuteRecord::minute_utc_s);
    return next == minutes.begin() ? scenario_.battery.soc_frac : (next - 1)->soc_frac;
  }
  [[nodiscard]] bool device_has_soc_limits() const {
    for (const CommandSequence& sequence : config_.map.command) {
      for (const BlockWrite& write : sequence.writes) {
        for (const WriteValue& value : write.values) {
          const bool is_limit = value.argument == Argument::kSocLimit ||
                                value.argument == Argument::kSocMin ||
                                value.argument == Argument::kSocMax;
          if (is_limit) return true;
        }
      }
    }
    return false;
  }
  /// By which the SoC may pass a bound: the device's own resolution, or what flows in a cycle.
  [[nodiscard]] double soc_margin_frac() const {
    constexpr double kResolutionFrac = 0.005;
    if (device_has_soc_limits()) return kResolutionFrac;
    const BatteryParameters& p = scenario_.battery.physics;
    const double hours = kHoursPerStep + evidence_.slack_s / 3'600;
    return kResolutionFrac + p.power_w_max * hours / p.capacity_wh / p.discharge_efficiency;
  }

  // --- rules --------------------------------------------------------------------------------------
  void find(std::int64_t utc_ns, std::string expected, std::string seen) {
    const bool is_known =
        std::ranges::any_of(findings_, [&](const Finding& f) { return f.rule == rule_; });
    if (is_known) return;
    findings_.push_back({.rule = rule_,
                         .utc_s = utc_ns / kSecondNs,
                         .expected = std::move(expected),
                         .seen = std::move(seen)});
  }

  void judge_soc_window() {
    const GuardSettings& guard = config_.control.guard;
    const double low = guard.soc_min_e4 / 1e4 - soc_margin_frac();
    const double high = guard.soc_max_e4 / 1e4 + soc_margin_frac();
    for (const MinuteRecord& m : evidence_.minutes) {
      if (m.soc_frac >= low && m.soc_frac <= high) continue;
      return find((m.minute_utc_s + 60) * kSecondNs,
                  fmt::format("a SoC from {:.4f} to {:.4f}", low, high),
                  fmt::format("{:.4f}", m.soc_frac));
    }
  }

  void judge_power_limit() {
    const double most_w = config_.control.guard.power_w * 1.001 + 1;
    for (const DispatchEvent& e : evidence_.orders) {
      if (std::abs(e.power_w) <= most_w) continue;
      return find(e.utc_ns, fmt::format("at most {} W", config_.control.guard.power_w),
                  fmt::format("an order of {:.0f} W", e.power_w));
    }
  }

  void judge_fresh_price() {
    each_tick([&](std::int64_t tick_ns) {
      const auto fresh = fresh_row(tick_ns);
      if ((fresh && !must_be_frozen(*fresh)) || is_disturbed_in_cycle(tick_ns)) return;
      const CommandInForce command = commands_.at(settled_ns(tick_ns));
      if (command.power_w == 0) return;
      const auto row = publication_.newest(tick_ns);
      find(
          settled_ns(tick_ns),
          row ? fmt::format("0 W, the newest price being of {}", utc_text(row->minute_utc_s).view())
              : "0 W, there being no price",
          watts(command));
    });
  }

  void judge_thresholds() {
    const GuardSettings& guard = config_.control.guard;
    each_tick([&](std::int64_t tick_ns) {
      const auto row = fresh_row(tick_ns);
      if (!row || may_be_frozen(*row) || is_disturbed_in_cycle(tick_ns)) return;
      const double price = row->eur_per_mwh;
      const bool is_low = price <= guard.thresholds.low_eur_per_mwh;
      const bool is_high = price >= guard.thresholds.high_eur_per_mwh;
      if (!is_low && !is_high) return;
      const double soc_e4 = 1e4 * soc_at(tick_ns);
      const double margin_e4 = guard.soc_hysteresis_e4 + 1e4 * soc_margin_frac();
      if (is_low && soc_e4 > guard.soc_max_e4 - margin_e4) return;
      if (is_high && soc_e4 < guard.soc_min_e4 + margin_e4) return;
      const double wanted_w = is_low ? guard.power_w : -guard.power_w;
      const CommandInForce command = commands_.at(settled_ns(tick_ns));
      if (std::abs(command.power_w - wanted_w) <= 0.01 * guard.power_w) return;
      find(settled_ns(tick_ns), fmt::format("{:.0f} W at {:.2f} EUR/MWh", wanted_w, price),
           watts(command));
    });
  }

  /// The student of this build, asked again with the logged price and SoC, the level counted anew.
  void judge_decision() {
    PriceLevel level = level_;
    for (const LoggedCycle& cycle : evidence_.log) {
      if (cycle.mode == Mode::kStopping) continue;
      if (cycle.has_price) level.observe(cycle.price_minute_utc_s, cycle.price_centi_eur_per_mwh);
      if (!cycle.has_student_action) continue;
      const LocalMinute now = local_minute_of(cycle.utc_s);
      const std::int16_t context = student_context_class(now, level);
      const Action action = decide_with_student(
          make_lattice_state(now, context, cycle.soc_e4, cycle.price_centi_eur_per_mwh));
      if (action != cycle.student_action || context != cycle.context_class) {
        find(cycle.utc_s * kSecondNs, fmt::format("{} in class {}", action_name(action), context),
             fmt::format("{} in class {}", action_name(cycle.student_action), cycle.context_class));
      }
      const std::int32_t power_w = power_sign(action) * config_.control.guard.power_w;
      if (cycle.reason != "student" || cycle.ordered_power_w == power_w) continue;
      find(cycle.utc_s * kSecondNs, fmt::format("the student's {} W", power_w),
           fmt::format("{} W", cycle.ordered_power_w));
    }
  }

  void judge_inputs() {
    constexpr double kSocToleranceE4 =
        100;  // a percent: resolution of registers, and what has flowed
    for (const LoggedCycle& cycle : evidence_.log) {
      if (cycle.mode == Mode::kStopping) continue;
      const std::int64_t tick_ns = cycle.utc_s * kSecondNs;
      if (cycle.has_price) {
        const auto price = publication_.price_of(cycle.price_minute_utc_s);
        const double seen = cycle.price_centi_eur_per_mwh / 100.0;
        if (!price || std::abs(*price - seen) > 0.0051) {
          find(tick_ns,
               fmt::format("{} for {}", price ? fmt::format("{:.2f} EUR/MWh", *price) : "no price",
                           utc_text(cycle.price_minute_utc_s).view()),
               fmt::format("{:.2f}", seen));
        }
      }
      if (!cycle.has_measurement || is_disturbed(tick_ns)) continue;
      const double soc_e4 = 1e4 * soc_at(tick_ns);
      const double flow_e4 = 1e4 * scenario_.battery.physics.power_w_max *
                             (60 + evidence_.slack_s) / 3'600 /
                             scenario_.battery.physics.capacity_wh;
      if (std::abs(soc_e4 - cycle.soc_e4) <= kSocToleranceE4 + flow_e4) continue;
      find(tick_ns, fmt::format("a SoC near {:.4f}", soc_e4 / 1e4),
           fmt::format("{:.4f}", cycle.soc_e4 / 1e4));
    }
  }

  void judge_order() {
    for (const LoggedCycle& cycle : evidence_.log) {
      const std::int64_t tick_ns = cycle.utc_s * kSecondNs;
      const std::int64_t by_ns = settled_at_worst_ns(tick_ns);
      const bool counts = cycle.mode == Mode::kRunning && cycle.written &&
                          by_ns < scenario_.end_utc_ns() && !is_lost(tick_ns);
      const auto is_in_force = [&](std::int64_t utc_ns) {
        const CommandInForce command = commands_.at(utc_ns);
        return command.is_driven && std::abs(command.power_w - cycle.ordered_power_w) <= 2;
      };
      if (!counts || is_in_force(settled_ns(tick_ns)) || is_in_force(by_ns)) continue;
      if (was_cut(tick_ns, by_ns, cycle.ordered_power_w)) continue;
      find(by_ns, fmt::format("{} W, as logged", cycle.ordered_power_w),
           watts(commands_.at(by_ns)));
    }
  }

  /// A site's limits may take power off an order before it is looked for.
  [[nodiscard]] bool has_site() const { return house_.has_value() || scenario_.has_limits(); }
  /// Between two ticks it only cuts, but what was taken in a quarter-hour is given back for its peak.
  [[nodiscard]] bool may_be_cut(double from_w, double to_w) const {
    const bool has_peak = config_.site.settings.connection.peak_w_max != kAnyPowerW;
    const bool is_less = std::abs(to_w) <= std::abs(from_w) + 2 && to_w * from_w >= 0;
    return has_site() && (is_less || (has_peak && to_w < from_w));
  }
  [[nodiscard]] bool was_cut(std::int64_t tick_ns, std::int64_t by_ns, double ordered_w) const {
    if (!may_be_cut(ordered_w, commands_.at(by_ns).power_w)) return false;
    return std::ranges::any_of(evidence_.orders, [&](const DispatchEvent& e) {
      return e.utc_ns >= tick_ns && e.utc_ns <= by_ns && std::abs(e.power_w - ordered_w) <= 2;
    });
  }

  [[nodiscard]] bool is_lost(std::int64_t tick_ns) const {
    return std::ranges::any_of(lost_, [&](const Window& w) {
      return tick_ns + kStepNs + slack_ns() > w.from_ns && tick_ns < w.to_ns;
    });
  }

  void judge_in_time() {
    CommandInForce before;
    for (const DispatchEvent& e : evidence_.orders) {
      const CommandInForce now = {.is_driven = e.kind == DispatchEvent::Kind::kOrder,
                                  .power_w = e.power_w};
      const bool is_cut = may_be_cut(before.power_w, now.power_w);
      const bool is_new = now.is_driven && now.power_w != 0 && !is_cut &&
                          std::abs(now.power_w - before.power_w) > 2;
      before = now;
      const std::int64_t after_tick_ns = e.utc_ns % kStepNs;
      const bool is_judged = e.utc_ns >= start_ns() && e.utc_ns < scenario_.end_utc_ns();
      const std::int64_t most_ns = config_.control.order_deadline_s * kSecondNs + slack_ns();
      // The wait for a reply to the last write of an order counts, that order's bytes are on their way.
      if (!is_new || !is_judged || after_tick_ns <= most_ns) continue;
      find(e.utc_ns,
           fmt::format("an order within {} s of its tick", config_.control.order_deadline_s),
           fmt::format("{:.0f} W after {:.1f} s", e.power_w,
                       static_cast<double>(after_tick_ns) / 1e9));
    }
  }

  void judge_in_control() {
    each_tick([&](std::int64_t tick_ns) {
      const auto row = fresh_row(tick_ns);
      if (!row || may_be_frozen(*row) || is_disturbed_in_cycle(tick_ns)) return;
      if (commands_.at(settled_ns(tick_ns)).is_driven) return;
      find(settled_ns(tick_ns), "an order in force", "no order");
    });
  }

  void judge_safe_state() {
    if (!evidence_.order_ends_by_itself) return;
    const std::int64_t timer_ns = evidence_.order_duration_s * kSecondNs + kStepNs + slack_ns();
    for (const Window& window : lost_) {
      const std::int64_t end_ns = std::min(window.to_ns, scenario_.end_utc_ns());
      for (std::int64_t t = window.from_ns + timer_ns; t < end_ns; t += 10 * kSecondNs) {
        const CommandInForce command = commands_.at(t);
        if (command.power_w == 0) continue;
        return find(t,
                    fmt::format("no power {} s after the link or the process was lost",
                                evidence_.order_duration_s + kSecondsPerStep),
                    watts(command));
      }
    }
  }

  void judge_fed() {
    for (const DispatchEvent& e : evidence_.orders) {
      if (e.kind != DispatchEvent::Kind::kExpiry || is_disturbed(e.utc_ns)) continue;
      if (e.utc_ns < start_ns() || e.utc_ns >= scenario_.end_utc_ns()) continue;
      return find(e.utc_ns, "an order that is fed in time", "it ran out");
    }
  }

  /// An end that the scenario asks for gives the battery back at once.
  [[nodiscard]] bool is_way_out(std::int64_t utc_ns) const {
    constexpr std::int64_t kPatienceNs = 75 * kSecondNs;
    const auto follows = [&](std::int64_t at_ns) {
      return utc_ns >= at_ns - slack_ns() && utc_ns < at_ns + kPatienceNs + slack_ns();
    };
    if (follows(scenario_.end_utc_ns())) return true;
    return std::ranges::any_of(scenario_.events, [&](const ScenarioEvent& event) {
      return event.does == ScenarioEvent::Does::kEdgeStop &&
             follows(scenario_.utc_ns_at(event.at_min));
    });
  }

  void judge_held() {
    std::int64_t since_ns = -1;  ///< of 0 W, held
    bool was_driven = false;
    for (const DispatchEvent& e : evidence_.orders) {
      if (e.kind == DispatchEvent::Kind::kOrder) {
        if (e.power_w != 0) since_ns = -1;
        if (e.power_w == 0 && since_ns < 0) since_ns = e.utc_ns;
        was_driven = true;
        continue;
      }
      const bool is_release = e.kind == DispatchEvent::Kind::kStop && was_driven;
      was_driven = false;
      const std::int64_t held_ns = since_ns < 0 ? 0 : e.utc_ns - since_ns;
      since_ns = -1;
      if (!is_release || is_way_out(e.utc_ns) || is_disturbed(e.utc_ns) || e.utc_ns < start_ns())
        continue;
      if (held_ns >= config_.control.hold_s * kSecondNs - slack_ns()) continue;
      return find(e.utc_ns,
                  fmt::format("0 W for {} s before it is given back", config_.control.hold_s),
                  fmt::format("{:.0f} s", static_cast<double>(held_ns) / 1e9));
    }
  }

  void judge_released() {
    if (evidence_.orders.empty()) return;
    const bool was_killed = evidence_.edge_exit_code == 128 + SIGKILL;
    if (was_killed && !evidence_.order_ends_by_itself) return;
    // What a killed edge leaves runs out by itself, if the scenario goes on for long enough.
    const CommandInForce last = commands_.at(INT64_MAX);
    if (last.is_driven)
      find(evidence_.orders.back().utc_ns, "no order left at the end", watts(last));
  }

  void judge_energy() {
    const BatteryParameters& p = scenario_.battery.physics;
    double stored_wh = 0;
    double moved_wh = 0;
    double unknown_wh = 0.5;
    double before_wh = 0;
    for (const MinuteRecord& m : evidence_.minutes) {
      // Of a minute that was charged and discharged in, the record knows the sum; the slowest battery that
      // is simulated turns 5 s after its order.
      if (m.energy_wh * before_wh < 0) {
        unknown_wh += p.power_w_max * (6 + evidence_.slack_s) / 3'600 *
                      (1 / p.discharge_efficiency - p.charge_efficiency);
      }
      before_wh = m.energy_wh;
      stored_wh += m.energy_wh > 0 ? m.energy_wh * p.charge_efficiency
                                   : m.energy_wh / p.discharge_efficiency;
      moved_wh += std::abs(m.energy_wh);
    }
    if (evidence_.minutes.empty()) return;
    const MinuteRecord& last = evidence_.minutes.back();
    const double by_soc_wh = (last.soc_frac - scenario_.battery.soc_frac) * p.capacity_wh;
    if (std::abs(stored_wh - by_soc_wh) <= 0.001 * moved_wh + unknown_wh) return;
    find((last.minute_utc_s + 60) * kSecondNs,
         fmt::format("{:.1f} Wh stored, by the energy", stored_wh),
         fmt::format("{:.1f} Wh by the SoC", by_soc_wh));
  }

  /// By the house's load and what the battery recorded of itself, and not by what any meter showed.
  void judge_connection() {
    if (!house_) return;
    const ConnectionSettings& limits = config_.site.settings.connection;
    // Of the one in which the house rose, the edge's next look cuts what is too much.
    const int minutes_max = 1 + static_cast<int>(std::ceil((evidence_.slack_s) / 60));
    int minutes_over = 0;
    for (const MinuteRecord& m : evidence_.minutes) {
      const double battery_w = 60 * m.energy_wh;
      const double grid_w = house_->power_w(m.minute_utc_s) + battery_w;
      const bool is_over = (battery_w > 0 && grid_w > limits.import_w_max) ||
                           (battery_w < 0 && -grid_w > limits.export_w_max);
      minutes_over = is_over ? minutes_over + 1 : 0;
      if (minutes_over <= minutes_max) continue;
      find(m.minute_utc_s * kSecondNs,
           battery_w > 0 ? fmt::format("at most {} W taken from the grid", limits.import_w_max)
                         : fmt::format("at most {} W given to the grid", limits.export_w_max),
           fmt::format("{:.0f} W, of which the battery {:.0f} W", grid_w, battery_w));
    }
    if (limits.peak_w_max != kAnyPowerW) judge_peaks(limits.peak_w_max);
  }

  void judge_peaks(double peak_w_max) {
    constexpr double kHours = 0.25;
    constexpr double kRoundTripWh = 10;  // of what it takes and gives back
    double import_wh = 0, battery_wh = 0;
    for (const MinuteRecord& m : evidence_.minutes) {
      if (m.minute_utc_s % kQuarterHourS == 0) import_wh = battery_wh = 0;
      import_wh += std::max(0.0, house_->power_w(m.minute_utc_s) / 60 + m.energy_wh);
      battery_wh += m.energy_wh;
      const bool is_over = m.minute_utc_s % kQuarterHourS == kQuarterHourS - 60;
      const bool is_above = import_wh > peak_w_max * kHours;
      if (!is_over || !is_above || battery_wh <= kRoundTripWh) continue;
      find(m.minute_utc_s * kSecondNs,
           fmt::format("at most {:.0f} W in the mean of a quarter-hour", peak_w_max),
           fmt::format("{:.0f} W, {:.0f} Wh of it the battery's", import_wh / kHours, battery_wh));
    }
  }

  // --- what the scenario expects of its own ---------------------------------------------------------
  static bool fits(Expectation::Command wanted, const CommandInForce& c) {
    using enum Expectation::Command;
    switch (wanted) {
      case kAny:
        return true;
      case kCharge:
        return c.power_w > 0;
      case kDischarge:
        return c.power_w < 0;
      case kZero:
        return c.is_driven && c.power_w == 0;
      case kNone:
        return !c.is_driven;
      case kDriven:
        return c.is_driven;
      case kNotDriven:
        return c.power_w == 0;
    }
    return false;
  }

  void judge_expectations() {
    constexpr const char* kNames[] = {"anything",        "charging",          "discharging",
                                      "0 W, held",       "no order in force", "an order in force",
                                      "no power ordered"};
    int number = 0;
    for (const Expectation& expectation : scenario_.expectations) {
      rule_ = fmt::format("expect {}", ++number);
      const std::int64_t from_ns = scenario_.utc_ns_at(expectation.span.from_min);
      const std::int64_t to_ns = expectation.span.to_min == kNeverMin
                                     ? scenario_.end_utc_ns()
                                     : scenario_.utc_ns_at(expectation.span.to_min);
      for (std::int64_t t = (from_ns + kStepNs - 1) / kStepNs * kStepNs; t < to_ns; t += kStepNs) {
        const CommandInForce command = commands_.at(settled_ns(t));
        if (!fits(expectation.command, command)) {
          find(settled_ns(t), kNames[static_cast<int>(expectation.command)], watts(command));
        } else if (command.power_w < expectation.power_w_min ||
                   command.power_w > expectation.power_w_max) {
          find(settled_ns(t),
               fmt::format("{:g} to {:g} W", expectation.power_w_min, expectation.power_w_max),
               watts(command));
        }
      }
      judge_reasons(expectation, {from_ns, to_ns});
    }
  }

  void judge_reasons(const Expectation& expectation, const Window& span) {
    bool was_seen = expectation.reason.empty();
    std::string last = "nothing logged";
    for (const LoggedCycle& cycle : evidence_.log) {
      const std::int64_t ns = cycle.utc_s * kSecondNs;
      if (ns < span.from_ns || ns >= span.to_ns) continue;
      last = cycle.reason;
      was_seen = was_seen || cycle.reason == expectation.reason;
      if (!expectation.no_reason.empty() && cycle.reason == expectation.no_reason) {
        find(ns, "another reason than " + expectation.no_reason, cycle.reason);
      }
    }
    if (!was_seen)
      find(span.from_ns, "the reason " + expectation.reason + " by the end of its span", last);
  }

  void judge_end() {
    rule_ = "end";
    if (evidence_.edge_exit_code != scenario_.exit_code) {
      find(scenario_.end_utc_ns(), fmt::format("exit code {} of the edge", scenario_.exit_code),
           fmt::format("{} ({})", evidence_.edge_exit_code, evidence_.edge_last_line));
    }
    if (!evidence_.is_alive_at_end) {
      find(scenario_.end_utc_ns(), "simulators that serve until the end", "one ended before");
    }
    if (evidence_.log.empty()) find(scenario_.end_utc_ns(), "a log of the edge", "none");
  }

  const Scenario& scenario_;
  const EdgeConfig& config_;
  const Evidence& evidence_;
  Publication publication_;
  CommandTimeline commands_;
  PriceLevel level_;
  std::optional<HouseLoad> house_;
  std::vector<Window> disturbed_;
  std::vector<Window> lost_;  ///< nobody can feed or end an order
  std::string rule_;
  std::vector<Finding> findings_;
};

const Judge::Rule Judge::kRules[] = {
#define BESS_ROW(name, text) {#name, &Judge::judge_##name},
    BESS_RULES(BESS_ROW)
#undef BESS_ROW
};

}  // namespace

std::vector<Finding> judge(const Trial& trial) { return Judge(trial).run(); }

}  // namespace bess
