// End conditions of reasons, with the values of this control cycle and these settings.
#include <string>
#include <string_view>

#include "edge/core/control/policy.h"
#include "edge/core/control/quarter_hour_energy.h"
#include "edge/records/why/explanation.h"
#include "shared/host/text.h"
#include "shared/local_time.h"

namespace bess {
namespace {

std::string percent_text(std::int32_t soc_e4) { return formatted("%.1f", soc_e4 / 100.0); }
std::string celsius(std::int32_t deci_c) { return formatted("%.1f", deci_c / 10.0); }
template <typename Text>
std::string string(const Text& text) {
  return std::string(text.view());
}

/// Names of the rules that apply at this point.
std::string rules_at(const CycleRecord& record) {
  const std::int32_t price_centi = decided_price_centi(record);
  const LocalMinute now = local_minute_of(record.utc_s);
  const LatticeState state =
      make_lattice_state(now, record.context_class, record.measurement.soc_e4, price_centi);
  std::string names;
  for (int i = 0; i < guard_rule_count(); ++i) {
    if (!guard_rule_holds(i, now, state, price_centi)) continue;
    names.append(names.empty() ? "" : ", ").append(guard_rule_name(i));
  }
  return names;
}

using Cycle = const CycleRecord&;
using Settings = const ControlSettings&;

/// Values that a row of the table may name in braces.
struct NamedValue {
  std::string_view name;
  std::string (*text)(Cycle, Settings);
};
const NamedValue kValues[] = {
    {"temperature_min_c",
     [](Cycle, Settings s) { return celsius(s.guard.temperature_min_deci_c); }},
    {"temperature_max_c",
     [](Cycle, Settings s) { return celsius(s.guard.temperature_max_deci_c); }},
    {"price_age_s_max", [](Cycle, Settings s) { return std::to_string(s.guard.price_age_s_max); }},
    {"stand_in_s_max", [](Cycle, Settings s) { return std::to_string(s.guard.stand_in_s_max); }},
    {"soc_below_full",
     [](Cycle, Settings s) {
       return percent_text(s.guard.soc_max_e4 - s.guard.soc_hysteresis_e4);
     }},
    {"soc_above_empty",
     [](Cycle, Settings s) {
       return percent_text(s.guard.soc_min_e4 + s.guard.soc_hysteresis_e4);
     }},
    {"soc_above_reserve",
     [](Cycle c, Settings s) {
       return percent_text(c.reserve_soc_e4 + s.guard.soc_hysteresis_e4);
     }},
    {"reversals_per_hour_max",
     [](Cycle, Settings s) { return std::to_string(s.reversals_per_hour_max); }},
    {"meter_pause_end",
     [](Cycle c, Settings) { return string(local_text(c.site.trust.pause_until_utc_s)); }},
    {"quarter_hour_end",
     [](Cycle c, Settings) {
       return string(local_clock_text((quarter_hour_of(c.utc_s) + 1) * kQuarterHourS));
     }},
    {"ramp_w_max", [](Cycle, Settings s) { return std::to_string(s.guard.ramp_w_max); }},
    {"hold_end", [](Cycle c, Settings) { return string(local_text(c.hold.until_utc_s)); }},
    {"rules", [](Cycle c, Settings) { return rules_at(c); }},
    {"low_price",
     [](Cycle, Settings s) { return std::to_string(s.guard.thresholds.low_eur_per_mwh); }},
    {"high_price",
     [](Cycle, Settings s) { return std::to_string(s.guard.thresholds.high_eur_per_mwh); }},
};

/// An unknown name stays in braces, for the test of the table.
std::string value_of(std::string_view name, Cycle record, Settings settings) {
  for (const NamedValue& value : kValues) {
    if (value.name == name) return value.text(record, settings);
  }
  return "{" + std::string(name) + "}";
}

}  // namespace

std::string what_ends(const CycleRecord& record, const ControlSettings& settings) {
  if (record.is_tripped && is_stop_reason(record.reason)) {
    return formatted("tripped at %s, until cleared with `bess-edge clear --yes`",
                     local_text(record.trip.utc_s).c_str());
  }
  std::string text;
  std::string_view rest = info_of(record.reason).ends;
  while (!rest.empty()) {
    const std::size_t open = rest.find('{');
    text += rest.substr(0, open);
    const std::size_t close = rest.find('}');
    if (open == rest.npos || close == rest.npos) break;
    text += value_of(rest.substr(open + 1, close - open - 1), record, settings);
    rest.remove_prefix(close + 1);
  }
  return text;
}

}  // namespace bess
