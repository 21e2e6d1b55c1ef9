#include "tools/hil_runner/run/agreement.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>

#include "shared/utc_text.h"
#include "tools/hil_runner/scenario/scenario_parts.h"

namespace bess {

namespace {

/// A run that cannot be completed counts as different.
bool is_same_run(const Outcome& one, const Outcome& other) {
  return other.error.empty() && one.signature == other.signature;
}

}  // namespace

std::vector<Finding> judge_parts(const Outcome& outcome) {
  const Scenario& scenario = outcome.scenario;
  std::vector<Finding> findings;
  const auto judge = [&](const std::string& part, bool is_same) {
    const auto excuse = scenario.same_without.find(part);
    if (is_same == (excuse != scenario.same_without.end())) return;
    findings.push_back(
        {.rule = "part " + part,
         .utc_s = scenario.start_utc_s,
         .expected = is_same ? "a different run without it, or a reason in [same_without]"
                             : fmt::format("the same run without it, as \"{}\"", excuse->second),
         .seen = is_same ? "bit-identical" : "a different run"});
  };
  const std::vector<ScenarioPart> parts = parts_of(scenario);
  if (parts.empty()) judge(std::string(kNothing), true);
  for (const ScenarioPart& part : parts) {
    judge(part.name, is_same_run(outcome, run_scenario(part.without, true, {})));
  }
  return findings;
}

namespace {

constexpr std::int32_t kAlikeW = 10;

const Outcome* in_wall_time(const std::vector<Outcome>& outcomes, const Outcome& of) {
  const auto found = std::ranges::find_if(outcomes, [&](const Outcome& o) {
    return !o.is_virtual && o.skipped.empty() && o.scenario.path == of.scenario.path;
  });
  return found == outcomes.end() ? nullptr : &*found;
}

bool is_far(std::int32_t one, std::int32_t other, std::int32_t at_most) {
  return std::abs(one - other) > at_most;
}

bool met_another_link(const CycleRecord& v, const CycleRecord& w) {
  return v.has_measurement != w.has_measurement || v.battery_status != w.battery_status;
}

bool met_another_price(const PriceReport& v, const PriceReport& w) {
  return v.has_row != w.has_row || v.minute_utc_s != w.minute_utc_s ||
         v.price_centi_eur_per_mwh != w.price_centi_eur_per_mwh || v.step_held != w.step_held;
}

bool met_other_words(const CycleRecord& v, const CycleRecord& w) {
  return v.hold.held != w.hold.held || v.hold.power_w != w.hold.power_w ||
         v.site.limit_status != w.site.limit_status;
}

bool met_another_meter(const SiteReport& v, const SiteReport& w) {
  return v.has_grid_power != w.has_grid_power || v.meter_status != w.meter_status ||
         is_far(v.grid_power_w, w.grid_power_w, kAlikeW) ||
         is_far(v.quarter_hour_import_wh, w.quarter_hour_import_wh, 0);
}

bool met_another_battery(const BatteryMeasurement& v, const BatteryMeasurement& w) {
  return v.soc_e4 != w.soc_e4 || is_far(v.power_w, w.power_w, kAlikeW) || v.alarm != w.alarm ||
         v.dispatch_active != w.dispatch_active || v.order_replaced != w.order_replaced ||
         v.order_ended != w.order_ended;
}

/// State from earlier control cycles: trips, waits and counters.
bool met_another_past(const CycleRecord& v, const CycleRecord& w) {
  return v.is_tripped != w.is_tripped || v.mode != w.mode ||
         v.unanswered_orders != w.unanswered_orders || v.weak_answers != w.weak_answers ||
         v.reversals.steps != w.reversals.steps || v.reversals.direction != w.reversals.direction;
}

std::string met_otherwise(const CycleRecord& v, const CycleRecord& w) {
  if (met_another_link(v, w)) return "link";
  if (met_another_price(v.price, w.price)) return "price";
  if (met_other_words(v, w)) return "words";
  if (met_another_meter(v.site, w.site)) return "meter";
  if (met_another_battery(v.measurement, w.measurement)) return "battery";
  return met_another_past(v, w) ? "before" : "";
}

void compare(const Outcome& simulated, const Outcome& real, Agreement& agreement) {
  const std::vector<CycleRecord>& log = real.evidence.log;
  auto r = log.begin();
  for (const CycleRecord& cycle : simulated.evidence.log) {
    while (r != log.end() && r->utc_s < cycle.utc_s) ++r;
    if (r == log.end()) return;
    // The end of a run is not an order at a tick.
    const bool is_both =
        r->utc_s == cycle.utc_s && cycle.mode != Mode::kStopping && r->mode != Mode::kStopping;
    if (!is_both) continue;
    ++agreement.cycles;
    if (!is_far(r->ordered_power_w, cycle.ordered_power_w, kAlikeW)) continue;
    agreement.otherwise.push_back(
        {.in_virtual = cycle, .in_wall = *r, .met = met_otherwise(cycle, *r)});
  }
}

std::string order_text(const CycleRecord& cycle) {
  return fmt::format("{} W ({})", cycle.ordered_power_w, reason_name(cycle.reason));
}

}  // namespace

bool Agreement::holds() const {
  if (!not_compared.empty()) return not_compared.starts_with(kTooLate);
  return std::ranges::none_of(otherwise, [](const OrderDifference& o) { return o.met.empty(); });
}

std::vector<Agreement> agreements_of(const std::vector<Outcome>& outcomes) {
  std::vector<Agreement> agreements;
  for (const Outcome& outcome : outcomes) {
    if (!outcome.is_virtual || !outcome.skipped.empty()) continue;
    const Outcome* const real = in_wall_time(outcomes, outcome);
    if (real == nullptr) continue;
    Agreement& agreement = agreements.emplace_back(
        Agreement{.scenario = outcome.scenario.name, .start_utc_s = outcome.scenario.start_utc_s});
    agreement.not_compared = outcome.error.empty() ? real->error : outcome.error;
    if (agreement.not_compared.empty()) compare(outcome, *real, agreement);
  }
  return agreements;
}

std::string agreement_table(const std::vector<Agreement>& agreements) {
  std::string text = fmt::format("{:32} {:>6} {:>6}  different orders and different inputs\n",
                                 "scenario", "cycles", "equal");
  for (const Agreement& a : agreements) {
    const auto alike = a.cycles - std::ssize(a.otherwise);
    text += fmt::format("{:32} {:6} {:6}  {}\n", a.scenario, a.cycles, alike, a.not_compared);
    for (const OrderDifference& o : a.otherwise) {
      text += fmt::format("  minute {:3}: {}, in wall time {}: {}\n",
                          (o.in_virtual.utc_s - a.start_utc_s) / 60, order_text(o.in_virtual),
                          order_text(o.in_wall), o.met.empty() ? "EQUAL INPUTS" : o.met);
    }
  }
  return text;
}

Json agreement_json(const std::vector<Agreement>& agreements) {
  const auto difference_json = [](const OrderDifference& o) {
    return Json::object({{"utc", utc_text(o.in_virtual.utc_s).view()},
                         {"virtual_w", o.in_virtual.ordered_power_w},
                         {"wall_w", o.in_wall.ordered_power_w},
                         {"met", o.met}});
  };
  return Json::list_from(agreements, [&](const Agreement& a) {
    Json json = Json::object({{"scenario", a.scenario}, {"cycles", a.cycles}});
    if (!a.not_compared.empty()) json.set("not_compared", a.not_compared);
    json.set("otherwise", Json::list_from(a.otherwise, difference_json));
    return json;
  });
}

std::string agreement_line(const std::vector<Agreement>& agreements) {
  if (agreements.empty()) return "";
  std::int64_t cycles = 0, otherwise = 0, on_the_same = 0;
  for (const Agreement& a : agreements) {
    cycles += a.cycles;
    otherwise += std::ssize(a.otherwise);
    on_the_same += std::ranges::count_if(a.otherwise, [](const auto& o) { return o.met.empty(); });
  }
  const std::string line =
      fmt::format("{} of {} control cycles of {} scenarios have equal orders in both times",
                  cycles - otherwise, cycles, agreements.size());
  if (otherwise == 0) return line;
  return fmt::format("{}, {} differ with different inputs, {} with equal inputs", line,
                     otherwise - on_the_same, on_the_same);
}

}  // namespace bess
