// Explanation of a control cycle, as text and JSON with the same values.

#include "edge/core/control/policy.h"
#include "edge/records/log/log_text.h"
#include "edge/records/why/explanation.h"
#include "shared/host/text.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

double percent(std::int32_t soc_e4) { return soc_e4 / 100.0; }

const char* doing(std::int32_t power_w) {
  return power_w > 0 ? "charging" : power_w < 0 ? "discharging" : "idle at";
}

/// Also at an estimated price.
bool is_students(const CycleRecord& record) {
  return record.reason == Reason::kStudent || record.reason == Reason::kStandIn;
}

void add_head(const CycleRecord& record, std::string& text) {
  add_formatted(text, "%s local time, control cycle %lld: ", local_text(record.utc_s).c_str(),
                static_cast<long long>(record.cycle));
  if (is_stop_reason(record.reason)) {
    add_formatted(text, "no control, mode %s\n", mode_name(record.mode).data());
  } else {
    add_formatted(text, "%s %d W\n", doing(record.ordered_power_w),
                  std::abs(record.ordered_power_w));
  }
}

void add_reason(const Explanation& explanation, const std::string& end, std::string& text) {
  const CycleRecord& record = explanation.record;
  const ReasonInfo& reason = info_of(record.reason);
  add_formatted(text, "reason     %s: %s; %d control cycle%s in a row since %s", reason.name.data(),
                reason.meaning, explanation.cycles, explanation.cycles == 1 ? "" : "s",
                local_text(explanation.since_utc_s).c_str());
  if (!end.empty()) text.append("; ").append(end);
  text += '\n';
  if (!is_students(record) && record.has_student_action) {
    add_formatted(text, "student    would choose: %s\n", action_name(record.student_action).data());
  }
}

void add_price(const Explanation& explanation, std::string& text) {
  const CycleRecord& record = explanation.record;
  if (!record.price.has_row) {
    text += "price      none\n";
    return;
  }
  add_formatted(text, "price      %.2f EUR/MWh, %d s old",
                eur_of(record.price.price_centi_eur_per_mwh), record.price_age_s);
  if (record.price_stands_in) {
    add_formatted(text, ", replaced by %.2f", eur_of(record.stand_in_centi_eur_per_mwh));
  }
  if (explanation.has_margins) {
    text.append("; ").append(price_margins_text(explanation.margins));
  }
  text += '\n';
}

void add_soc(const Explanation& explanation, std::string& text) {
  const CycleRecord& record = explanation.record;
  if (!record.has_measurement) {
    text += "SoC        not measured\n";
    return;
  }
  add_formatted(text, "SoC        %.1f %%", percent(record.measurement.soc_e4));
  if (explanation.has_margins) {
    const Margins& at = explanation.margins;
    // The class falls with SoC; the log has only the class of this SoC.
    text += record.outlook.source == OutlookSource::kNone ? "; at this price "
                                                          : "; at this price and class ";
    if (at.charges_at_some_soc)
      add_formatted(text, "charges up to %.2f %%", percent(at.charge_up_to_soc_e4));
    if (at.charges_at_some_soc && at.discharges_at_some_soc) text += " and ";
    if (at.discharges_at_some_soc) {
      add_formatted(text, "discharges from %.2f %%", percent(at.discharge_from_soc_e4));
    }
    if (!at.charges_at_some_soc && !at.discharges_at_some_soc) text += "idle at any SoC";
  }
  text += '\n';
}

void add_level(const CycleRecord& record, std::string& text) {
  if (record.context_class == 0 || student_context().kind != ContextKind::kLevel) return;
  add_formatted(text, "level      %.2f EUR/MWh, class %d of %d (1 = lowest)\n",
                eur_of(record.price_level.centi_eur_per_mwh()), record.context_class,
                kContextClassCount);
}

/// "tomorrow 07:00 (180.20)"
std::string moment_text(const PricedQuarterHour& moment, std::int64_t now_utc_s) {
  const bool is_today = local_day_number(local_minute_of(moment.utc_s)) ==
                        local_day_number(local_minute_of(now_utc_s));
  return formatted("%s %s (%.2f)", is_today ? "today" : "tomorrow",
                   local_clock_text(moment.utc_s).c_str(), eur_of(moment.centi_eur_per_mwh));
}

void add_outlook(const CycleRecord& record, std::string& text) {
  const OutlookReport& outlook = record.outlook;
  if (outlook.source == OutlookSource::kNone) return;
  add_formatted(text, "outlook    %s: the plan charges below %.2f EUR/MWh",
                outlook_source_name(outlook.source).data(), eur_of(outlook.break_even_centi));
  if (outlook.known_quarter_hours > 0) {
    text += " because " + moment_text(outlook.dearest, record.utc_s) + " is expensive and " +
            moment_text(outlook.cheapest, record.utc_s) + " is cheap";
  } else {
    text += " with typical prices of this hour and level: no day-ahead price is published";
  }
  add_formatted(text, "; class %d of %d (1 = lowest)\n", record.context_class, kContextClassCount);
}

void add_limits(const CycleRecord& record, const ControlSettings& settings, std::string& text) {
  const GuardSettings& guard = settings.guard;
  add_formatted(text, "always     charges at or below %d, discharges at or above %d EUR/MWh\n",
                guard.thresholds.low_eur_per_mwh, guard.thresholds.high_eur_per_mwh);
  add_formatted(text, "limits     full at %.1f %%, empty at %.1f %%", percent(guard.soc_max_e4),
                percent(guard.soc_min_e4));
  if (record.reserve_soc_e4 > 0)
    add_formatted(text, ", reserve %.1f %%", percent(record.reserve_soc_e4));
  add_formatted(text, "; %.2f", record.throughput.soc_moved_e4 / (2.0 * kSocFullE4));
  if (settings.cycles_per_day_max_e4 > 0) {
    add_formatted(text, " of %.2f", settings.cycles_per_day_max_e4 / 10'000.0);
  }
  text += " full cycles today";
  if (settings.reversals_per_hour_max > 0) {
    add_formatted(text, ", %d of %d reversals in the last hour", record.reversals.in_hour,
                  settings.reversals_per_hour_max);
  }
  text += '\n';
}

void add_evidence(const Explanation& explanation, std::string& text) {
  const char* head = "evidence";
  for (const CycleRecord& cycle : explanation.evidence) {
    add_formatted(text, "%-10s %s: ordered %d W, measured %d W, SoC %.2f %%\n", head,
                  local_text(cycle.utc_s).c_str(), cycle.followed.power_w,
                  cycle.measurement.power_w, percent(cycle.measurement.soc_e4));
    head = "";
  }
}

Json evidence_json(const Explanation& explanation) {
  return Json::list_from(explanation.evidence, [](const CycleRecord& cycle) {
    return Json::object({{"utc", utc_text(cycle.utc_s).view()},
                         {"ordered_power_w", cycle.followed.power_w},
                         {"measured_power_w", cycle.measurement.power_w},
                         {"soc_percent", Decimals{percent(cycle.measurement.soc_e4), 2}}});
  });
}

Json outlook_json(const OutlookReport& outlook) {
  if (outlook.source == OutlookSource::kNone) return Json::null();
  const auto moment = [&](const PricedQuarterHour& at) {
    if (outlook.known_quarter_hours == 0) return Json::null();
    return Json::object({{"utc", utc_text(at.utc_s).view()},
                         {"eur_per_mwh", Decimals{eur_of(at.centi_eur_per_mwh), 2}}});
  };
  return Json::object({{"source", outlook_source_name(outlook.source)},
                       {"break_even_eur_per_mwh", Decimals{eur_of(outlook.break_even_centi), 2}},
                       {"known_quarter_hours", outlook.known_quarter_hours},
                       {"dearest", moment(outlook.dearest)},
                       {"cheapest", moment(outlook.cheapest)}});
}

}  // namespace

std::string price_margins_text(const Margins& at) {
  std::string text = formatted("charges up to %.2f", eur_of(at.charge_up_to_centi));
  if (at.discharge_from_centi > at.charge_up_to_centi + 1) {
    add_formatted(text, ", idle from %.2f to %.2f", eur_of(at.charge_up_to_centi + 1),
                  eur_of(at.discharge_from_centi - 1));
  }
  add_formatted(text, ", discharges from %.2f", eur_of(at.discharge_from_centi));
  return text;
}

Json margins_json(const Margins& at) {
  return Json::object(
      {{"charge_up_to_eur_per_mwh", Decimals{eur_of(at.charge_up_to_centi), 2}},
       {"discharge_from_eur_per_mwh", Decimals{eur_of(at.discharge_from_centi), 2}},
       {"charge_up_to_soc_percent",
        value_or_null(at.charges_at_some_soc, Decimals{percent(at.charge_up_to_soc_e4), 2})},
       {"discharge_from_soc_percent",
        value_or_null(at.discharges_at_some_soc, Decimals{percent(at.discharge_from_soc_e4), 2})}});
}

std::string explanation_text(const Explanation& explanation, const ControlSettings& settings) {
  const CycleRecord& record = explanation.record;
  std::string text;
  add_head(record, text);
  add_reason(explanation, what_ends(record, settings), text);
  add_evidence(explanation, text);
  add_price(explanation, text);
  add_soc(explanation, text);
  add_level(record, text);
  add_outlook(record, text);
  add_limits(record, settings, text);
  if (explanation.is_other_student) {
    text +=
        "note       another version decided this control cycle; the margins above are those of the "
        "student of this version, which decides differently\n";
  }
  return text;
}

Json explanation_json(const Explanation& explanation, const ControlSettings& settings) {
  const CycleRecord& record = explanation.record;
  const GuardSettings& guard = settings.guard;
  const bool has_price = record.price.has_row;
  Json thresholds =
      Json::object({{"charge_at_or_below_eur_per_mwh", guard.thresholds.low_eur_per_mwh},
                    {"discharge_at_or_above_eur_per_mwh", guard.thresholds.high_eur_per_mwh}});
  Json limits = Json::object(
      {{"soc_max_percent", Decimals{percent(guard.soc_max_e4), 2}},
       {"soc_min_percent", Decimals{percent(guard.soc_min_e4), 2}},
       {"reserve_soc_percent", Decimals{percent(record.reserve_soc_e4), 2}},
       {"full_cycles_today", Decimals{record.throughput.soc_moved_e4 / (2.0 * kSocFullE4), 4}},
       {"reversals_in_hour", record.reversals.in_hour}});
  return Json::object(
      {{"utc", utc_text(record.utc_s).view()},
       {"local", local_text(record.utc_s).view()},
       {"cycle", record.cycle},
       {"mode", mode_name(record.mode)},
       {"ordered_power_w", record.ordered_power_w},
       {"reason", reason_name(record.reason)},
       {"meaning", info_of(record.reason).meaning},
       {"remedy", info_of(record.reason).look_at},
       {"since_utc", utc_text(explanation.since_utc_s).view()},
       {"cycles_with_reason", explanation.cycles},
       {"ends", what_ends(record, settings)},
       {"student", value_or_null(record.has_student_action, action_name(record.student_action))},
       {"price_eur_per_mwh",
        value_or_null(has_price, Decimals{eur_of(record.price.price_centi_eur_per_mwh), 2})},
       {"price_age_s", value_or_null(has_price, record.price_age_s)},
       {"soc_percent",
        value_or_null(record.has_measurement, Decimals{percent(record.measurement.soc_e4), 2})},
       {"level_eur_per_mwh",
        value_or_null(record.context_class != 0,
                      Decimals{eur_of(record.price_level.centi_eur_per_mwh()), 2})},
       {"context_class", record.context_class},
       {"outlook", outlook_json(record.outlook)},
       {"margins", value_or_null(explanation.has_margins, margins_json(explanation.margins))},
       {"is_other_student", explanation.is_other_student},
       {"evidence", evidence_json(explanation)},
       {"thresholds", std::move(thresholds)},
       {"limits", std::move(limits)}});
}

}  // namespace bess
