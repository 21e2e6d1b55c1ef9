#include "edge/records/why/next_decision.h"

#include <algorithm>
#include <cstdlib>

#include "edge/core/control/policy.h"
#include "edge/records/log/log_text.h"
#include "edge/records/why/explanation.h"
#include "shared/host/text.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

Action decide_at(const LatticeState& state, std::int32_t price_centi,
                 const PriceThresholds& thresholds) {
  const Action of_price = thresholds.action_beyond(price_centi);
  return of_price == Action::kIdle ? decide_with_student(state) : of_price;
}

/// State at the next tick, at constant price and SoC.
LatticeState state_at(const CycleRecord& newest, std::int64_t utc_s) {
  const LocalMinute then = local_minute_of(utc_s);
  return make_lattice_state(then, student_context_class(then, context_centi_of(newest)),
                            newest.measurement.soc_e4, decided_price_centi(newest));
}

void add_metric(const char* name, const char* help, double value, std::string& text) {
  add_formatted(text, "# HELP %s %s\n# TYPE %s gauge\n%s %.2f\n", name, help, name, name, value);
}

/// Reserves begin and end on whole minutes.
std::vector<ReserveChange> changes_ahead(const ReservePlan& plan, std::int64_t now_utc_s) {
  std::vector<ReserveChange> changes;
  std::int16_t before_e4 = reserve_soc_e4_at(plan, local_minute_of(now_utc_s));
  const std::int64_t first_s = (now_utc_s / 60 + 1) * 60;
  for (std::int64_t utc_s = first_s; utc_s <= now_utc_s + kSecondsPerDay; utc_s += 60) {
    const std::int16_t soc_e4 = reserve_soc_e4_at(plan, local_minute_of(utc_s));
    if (soc_e4 != before_e4) changes.push_back({utc_s, soc_e4});
    before_e4 = soc_e4;
  }
  return changes;
}

const char* doing(Action action) {
  if (action == Action::kIdle) return "idle";
  return action == Action::kCharge ? "charging" : "discharging";
}

std::string ahead_text(const NextDecision& next) {
  std::string text;
  for (const ReserveChange& change : next.reserve_changes) {
    text += text.empty() ? "" : ", ";
    text += change.soc_e4 > 0 ? formatted("reserve SoC %.1f %% from ", change.soc_e4 / 100.0)
                              : std::string("no reserve from ");
    text += local_clock_text(change.utc_s).c_str();
  }
  if (next.full_charge_in_days < 0) return text;
  text += text.empty() ? "" : ", ";
  if (next.full_charge_in_days == 0) return text + "a full charge is due";
  const auto days = static_cast<std::size_t>(next.full_charge_in_days);
  return text + "a full charge in " + counted(days, "day");
}

}  // namespace

NextDecision find_next_decision(const CycleRecord& newest, std::int64_t now_utc_s,
                                const ControlSettings& settings) {
  NextDecision next;
  next.utc_s = (now_utc_s / kSecondsPerStep + 1) * kSecondsPerStep;
  next.has_action = newest.has_measurement && newest.price.has_row;
  if (next.has_action) {
    const LatticeState state = state_at(newest, next.utc_s);
    const std::int32_t price_centi = decided_price_centi(newest);
    const PriceThresholds& thresholds = settings.guard.thresholds;
    next.action = decide_at(state, price_centi, thresholds);
    next.margins = find_margins(state, price_centi, thresholds, decide_with_student);
    next.power_w = power_sign(next.action) * settings.guard.power_w;
  }
  if (newest.reason != Reason::kStudent) {
    next.reason = reason_name(newest.reason);
    next.ends = what_ends(newest, settings);
  }
  if (!settings.reserve.empty()) next.reserve_changes = changes_ahead(settings.reserve, now_utc_s);
  if (settings.full_charge_every_days > 0) {
    next.full_charge_in_days =
        std::max(0, settings.full_charge_every_days - newest.days_since_full);
  }
  return next;
}

std::string next_decision_text(const NextDecision& next) {
  std::string text = std::string("next       ") + local_clock_text(next.utc_s).c_str();
  if (next.has_action) {
    text += std::string(", ") + doing(next.action);
    if (next.power_w != 0) text += formatted(" %d W", std::abs(next.power_w));
    text += " if price and SoC stay";
  } else {
    text += ", no control without price and measurement";
  }
  if (!next.reason.empty()) {
    text += "; " + next.reason + " overrides it";
    if (!next.ends.empty()) text += ", " + next.ends;
  }
  text += '\n';
  const std::string ahead = ahead_text(next);
  return ahead.empty() ? text : text + "ahead      " + ahead + "\n";
}

std::string next_decision_metrics(const NextDecision& next) {
  std::string text;
  if (!next.has_action) return text;
  add_metric("bess_charge_up_to_eur_per_mwh",
             "Price up to which the student would charge at the next tick, at this SoC.",
             eur_of(next.margins.charge_up_to_centi), text);
  add_metric("bess_discharge_from_eur_per_mwh",
             "Price from which the student would discharge at the next tick, at this SoC.",
             eur_of(next.margins.discharge_from_centi), text);
  return text;
}

Json next_decision_json(const NextDecision& next) {
  const auto change_json = [](const ReserveChange& change) {
    return Json::object({{"utc", utc_text(change.utc_s).view()},
                         {"soc_percent", Decimals{change.soc_e4 / 100.0, 2}}});
  };
  return Json::object({{"utc", utc_text(next.utc_s).view()},
                       {"local", local_text(next.utc_s).view()},
                       {"reason", next.reason},
                       {"ends", next.ends},
                       {"action", value_or_null(next.has_action, action_name(next.action))},
                       {"power_w", value_or_null(next.has_action, next.power_w)},
                       {"margins", value_or_null(next.has_action, margins_json(next.margins))},
                       {"reserve_changes", Json::list_from(next.reserve_changes, change_json)},
                       {"full_charge_in_days",
                        value_or_null(next.full_charge_in_days >= 0, next.full_charge_in_days)}});
}

}  // namespace bess
