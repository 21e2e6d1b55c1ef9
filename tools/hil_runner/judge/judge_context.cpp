#include "tools/hil_runner/judge/judge_context.h"

#include <algorithm>
#include <cmath>

#include "edge/core/control/quarter_hour_energy.h"
#include "tools/hil_runner/scenario/edge_settings.h"
#include "tools/hil_runner/scenario/scenario_parts.h"

namespace bess {
namespace {

PriceLevel level_at_start(const JudgedRun& judged_run) {
  // From prices published at the start of the edge, one minute before that of the scenario.
  if (const int hours = judged_run.scenario.prices.history_hours; hours > 0) {
    return level_before(judged_run.prices, judged_run.scenario.start_utc_s - 60, hours);
  }
  const auto& setting = judged_run.config.price.level_start_centi_eur_per_mwh;
  return setting ? PriceLevel::starting_at(*setting) : PriceLevel{};
}

}  // namespace

JudgeContext::JudgeContext(const JudgedRun& judged_run)
    : JudgedRun(judged_run), publication(scenario, prices), level(level_at_start(judged_run)) {
  if (scenario.house.exists()) house.emplace(house_load(scenario));
  find_disturbances();
}

void JudgeContext::find(std::int64_t utc_ns, std::string expected, std::string seen) {
  const bool is_known =
      std::ranges::any_of(findings_, [&](const Finding& f) { return f.rule == rule; });
  if (is_known) return;
  findings_.push_back({.rule = rule,
                       .utc_s = utc_ns / kSecondNs,
                       .expected = std::move(expected),
                       .seen = std::move(seen)});
}

std::vector<Finding> JudgeContext::findings() {
  std::ranges::stable_sort(findings_, {}, &Finding::utc_s);
  return std::move(findings_);
}

void JudgeContext::add_disturbance(const Window& span, bool is_loss) {
  const auto recovery_ns = static_cast<std::int64_t>(scenario.recovery_min * 60e9);
  if (is_loss) lost.push_back(span);
  disturbed_.push_back(
      {span.from_ns, span.to_ns == INT64_MAX ? INT64_MAX : span.to_ns + recovery_ns});
}

void JudgeContext::add_spans(std::initializer_list<ScenarioEvent::EventKind> begin,
                             ScenarioEvent::EventKind end, bool is_loss) {
  std::int64_t from_ns = -1;
  for (const ScenarioEvent& event : scenario.events) {
    const std::int64_t at_ns = scenario.utc_ns_at(event.at_min);
    const bool begins = std::ranges::find(begin, event.kind) != begin.end();
    if (event.kind == end && from_ns >= 0) {
      add_disturbance({from_ns, at_ns}, is_loss);
      from_ns = -1;
    } else if (begins && from_ns < 0) {
      from_ns = at_ns;
    }
  }
  if (from_ns >= 0) add_disturbance({from_ns, INT64_MAX}, is_loss);
}

void JudgeContext::find_disturbances() {
  for (const FaultSchedule& fault : scenario.battery_faults) {
    const bool is_silent =
        fault.strikes_always() && std::ranges::all_of(fault.faults, [](BatteryFault kind) {
          return kind == BatteryFault::kSilence || kind == BatteryFault::kDrop ||
                 kind == BatteryFault::kReset || kind == BatteryFault::kHalfOpen;
        });
    add_disturbance({scenario.utc_ns_at(fault.from_s / 60), scenario.utc_ns_at(fault.to_s / 60)},
                    is_silent);
  }
  using enum ScenarioEvent::EventKind;
  add_spans({kEdgeKill, kEdgeStop, kEdgeHandOver}, kEdgeStart, true);
  add_spans({kEdgePause}, kEdgeContinue, true);
  add_spans({kBatteryPause}, kBatteryContinue, true);
  add_spans({kClockUnsynchronised}, kClockSynchronised, false);
  add_spans({kClockStep}, kClockStep, false);
}

bool JudgeContext::is_disturbed(std::int64_t ns) const {
  return std::ranges::any_of(
      disturbed_, [&](const Window& w) { return ns >= w.from_ns - slack_ns() && ns < w.to_ns; });
}

bool JudgeContext::is_lost(std::int64_t tick_ns) const {
  return std::ranges::any_of(lost, [&](const Window& w) {
    return tick_ns + kStepNs + slack_ns() > w.from_ns && tick_ns < w.to_ns;
  });
}

bool JudgeContext::has_stood(const Publication::Row& row, std::int64_t longer_s) const {
  const std::int32_t stop_s = config.control.frozen_price.stop_s;
  const std::int64_t first_utc_s = row.minute_utc_s - stop_s - longer_s;
  if (stop_s == 0 || first_utc_s < scenario.start_utc_s - 60) return false;
  for (std::int64_t utc_s = first_utc_s; utc_s < row.minute_utc_s; utc_s += 60) {
    const auto price = publication.price_of(utc_s);
    if (price && *price != row.eur_per_mwh) return false;
  }
  return true;
}

std::optional<Publication::Row> JudgeContext::fresh_row(std::int64_t tick_ns) const {
  const auto row = publication.newest(tick_ns + config.control.price_wait_s * kSecondNs);
  if (!row) return std::nullopt;
  const std::int64_t tick_utc_s = tick_ns / kSecondNs;
  const bool is_fresh =
      price_age_s(tick_utc_s, row->minute_utc_s) <= config.control.guard.price_age_s_max &&
      quarter_hour_of(tick_utc_s) - quarter_hour_of(row->minute_utc_s) <= 1;
  return is_fresh ? row : std::nullopt;
}

bool JudgeContext::may_stand_in(std::int64_t tick_ns) const {
  const GuardSettings& guard = config.control.guard;
  const auto row = publication.newest(tick_ns + config.control.price_wait_s * kSecondNs);
  return row && guard.stand_in_s_max > 0 &&
         price_age_s(tick_ns / kSecondNs, row->minute_utc_s) <=
             guard.price_age_s_max + guard.stand_in_s_max;
}

double JudgeContext::soc_at(std::int64_t utc_ns) const {
  const std::int64_t minute_utc_s = utc_ns / kSecondNs / 60 * 60;
  const auto& minutes = evidence.minutes;
  auto next = std::ranges::lower_bound(minutes, minute_utc_s, {}, &MinuteRecord::minute_utc_s);
  return next == minutes.begin() ? scenario.battery.soc_frac : (next - 1)->soc_frac;
}

CommandInForce JudgeContext::command_at(std::int64_t utc_ns) const {
  const auto next = std::ranges::upper_bound(evidence.orders, utc_ns, {}, &DispatchEvent::utc_ns);
  if (next == evidence.orders.begin()) return {};
  const DispatchEvent& last = *(next - 1);
  if (last.kind != DispatchEvent::Kind::kOrder || last.duration_s <= 0) return {};
  return {.is_driven = true, .power_w = last.power_w};
}

bool JudgeContext::device_has_soc_limits() const {
  bool has_limits = false;
  for_each_written(config.battery.map, [&](const WriteValue& value) {
    has_limits = has_limits || value.argument == Argument::kSocLimit ||
                 value.argument == Argument::kSocMin || value.argument == Argument::kSocMax;
  });
  return has_limits;
}

double JudgeContext::soc_margin_frac() const {
  constexpr double kResolutionFrac = 0.005;
  if (device_has_soc_limits()) return kResolutionFrac;
  const BatteryParameters& p = scenario.battery.physics;
  const double hours = kHoursPerStep + evidence.slack_s / 3'600;
  return kResolutionFrac + p.power_w_max * hours / p.capacity_wh / p.discharge_efficiency;
}

bool JudgeContext::may_be_cut(double from_w, double to_w) const {
  const bool has_peak = config.site.settings.connection.peak_w_max != kAnyPowerW;
  const bool is_less = std::abs(to_w) <= std::abs(from_w) + 2 && to_w * from_w >= 0;
  return (house.has_value() || scenario.has_limits()) && (is_less || (has_peak && to_w < from_w));
}

bool JudgeContext::was_cut(std::int64_t tick_ns, std::int64_t by_ns, double ordered_w) const {
  if (!may_be_cut(ordered_w, command_at(by_ns).power_w)) return false;
  const auto is_ordered = [&](double power_w) { return std::abs(power_w - ordered_w) <= 2; };
  // An order already in force is not written again.
  const CommandInForce found = command_at(tick_ns);
  if (found.is_driven && is_ordered(found.power_w)) return true;
  return std::ranges::any_of(evidence.orders, [&](const DispatchEvent& e) {
    return e.utc_ns >= tick_ns && e.utc_ns <= by_ns && is_ordered(e.power_w);
  });
}

std::vector<Finding> judge(const JudgedRun& judged_run) {
  JudgeContext judging(judged_run);
  const auto is_judged = [&](const char* name) {
    const auto& judged = judged_run.scenario.invariants;
    return std::ranges::find(judged, name) != judged.end();
  };
#define BESS_ROW(name, text) \
  if (is_judged(#name)) {    \
    judging.rule = #name;    \
    judge_##name(judging);   \
  }
  BESS_RULES(BESS_ROW)
#undef BESS_ROW
  judge_expectations(judging);
  judge_end(judging);
  return judging.findings();
}

}  // namespace bess
