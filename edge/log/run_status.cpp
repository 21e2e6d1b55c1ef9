#include "edge/log/run_status.h"

#include "shared/utc_text.h"

namespace bess {
namespace {

long long as_long(std::int64_t value) { return value; }
const char* as_bool(bool value) { return value ? "true" : "false"; }

/// Text from a file (map names, provenance) inside quotes: what JSON and Prometheus must not meet
/// there is replaced by a space or an apostrophe.
template <int kCapacity>
FixedText<kCapacity> quotable(const FixedText<kCapacity>& text) {
  char plain[kCapacity + 1];
  std::size_t size = 0;
  for (const char c : text.view()) {
    const bool is_quote = c == '"' || c == '\\';
    plain[size++] = is_quote ? '\'' : static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return FixedText<kCapacity>(std::string_view(plain, size));
}

void add_identity(const RunIdentity& id, TextBuffer& json) {
  json.add("  \"version\": \"%s\",\n  \"student\": \"%08x\",\n  \"provenance\": \"%s\",\n",
           id.version.c_str(), id.student_hash, quotable(id.student_provenance).c_str());
  json.add("  \"map\": \"%s\",\n  \"variant\": \"%s\",\n  \"battery\": \"%s\",\n",
           quotable(id.map).c_str(), quotable(id.variant).c_str(), quotable(id.battery).c_str());
  json.add("  \"control\": %s,\n  \"pid\": %d,\n  \"start_utc\": \"%s\",\n  \"cadence_ms\": %d,\n",
           as_bool(id.control), static_cast<int>(id.pid), utc_text(id.start_utc_s).c_str(),
           id.cadence_ms);
}

void add_last_cycle(const CycleRecord& r, TextBuffer& json) {
  json.add("  \"last\": {\n    \"utc\": \"%s\", \"cycle\": %lld, \"mode\": \"%s\",\n",
           utc_text(r.utc_s).c_str(), as_long(r.cycle), mode_name(r.mode).data());
  json.add("    \"has_measurement\": %s, \"soc_e4\": %d, \"battery_power_w\": %d,\n",
           as_bool(r.has_measurement), r.measurement.soc_e4, r.measurement.power_w);
  json.add("    \"alarm\": %s, \"off_grid\": %s, \"dispatch_active\": %s,\n",
           as_bool(r.measurement.alarm), as_bool(r.measurement.off_grid),
           as_bool(r.measurement.dispatch_active));
  json.add(
      "    \"has_price\": %s, \"price_minute_utc\": \"%s\", \"price_centi_eur_per_mwh\": %d,\n",
      as_bool(r.price.has_row), utc_text(r.price.minute_utc_s).c_str(),
      r.price.price_centi_eur_per_mwh);
  json.add("    \"price_age_s\": %d, \"large_step\": %s, \"price_status\": \"%s\",\n",
           r.price_age_s, as_bool(r.price.large_step), status_name(r.price.status).data());
  json.add("    \"student_action\": \"%s\", \"ordered_power_w\": %d, \"reason\": \"%s\",\n",
           r.has_student_action ? action_name(r.student_action).data() : "none", r.ordered_power_w,
           reason_name(r.reason).data());
  json.add("    \"battery_status\": \"%s\", \"written\": %s,\n",
           status_name(r.battery_status).data(), as_bool(r.written));
  json.add("    \"fetch_us\": %d, \"decision_us\": %d, \"write_us\": %d, \"total_us\": %d\n  },\n",
           r.price.fetch_us, r.decision_us, r.write_us, r.total_us);
}

void add_totals(const RunTotals& t, TextBuffer& json) {
  const BatteryCounters& c = t.last.counters;
  json.add(
      "  \"totals\": {\n    \"cycles\": %lld, \"missed_ticks\": %d, \"written_orders\": %lld,\n",
      as_long(t.cycles), t.last.missed_ticks, as_long(t.written_orders));
  json.add("    \"deadline_misses\": %d, \"unanswered_orders\": %d, \"soc_moved_e4_today\": %d,\n",
           t.last.deadline_misses, t.last.unanswered_orders, t.last.throughput.soc_moved_e4);
  json.add("    \"battery_failures\": %lld, \"price_failures\": %lld,\n",
           as_long(t.battery_failures), as_long(t.price_failures));
  json.add("    \"records_dropped\": %lld, \"disk_failures\": %lld,\n", as_long(t.records_dropped),
           as_long(t.disk_failures));
  json.add("    \"disk_is_slow\": %s, \"disk_is_failing\": %s,\n", as_bool(t.disk_is_slow),
           as_bool(t.disk_is_failing));
  json.add("    \"requests\": %lld, \"failed_requests\": %lld, \"reconnects\": %lld,\n",
           as_long(c.requests), as_long(c.failed_requests), as_long(c.reconnects));
  json.add(
      "    \"register_writes\": %lld, \"unchanged_orders\": %lld, \"flash_writes_today\": %d\n",
      as_long(c.register_writes), as_long(c.unchanged_orders), c.flash_writes_today);
  json.add("  },\n  \"cycles_by_reason\": {");
  for (int i = 0; i < kReasonCount; ++i) {
    json.add("%s\n    \"%s\": %lld", i == 0 ? "" : ",", reason_name(static_cast<Reason>(i)).data(),
             as_long(t.cycles_by_reason[static_cast<std::size_t>(i)]));
  }
  json.add("\n  }\n");
}

void add_head(TextBuffer& text, const char* name, const char* type, const char* help) {
  text.add("# HELP %s %s\n# TYPE %s %s\n", name, help, name, type);
}

void add_value(TextBuffer& text, const char* name, const char* type, const char* help,
               double value) {
  add_head(text, name, type, help);
  text.add("%s %.10g\n", name, value);
}

/// A measurement that is not there must be absent, not zero.
void add_battery_and_price(const CycleRecord& r, TextBuffer& text) {
  if (r.has_measurement) {
    add_value(text, "bess_soc_ratio", "gauge", "State of charge of the battery, 0 to 1.",
              r.measurement.soc_e4 / 10'000.0);
    add_value(text, "bess_power_watts", "gauge", "Power of the battery, positive when it charges.",
              r.measurement.power_w);
  }
  add_value(text, "bess_setpoint_watts", "gauge", "Power ordered, positive is charging.",
            r.ordered_power_w);
  if (!r.price.has_row) return;
  add_value(text, "bess_price_eur_per_mwh", "gauge", "Imbalance price the decision was made with.",
            r.price.price_centi_eur_per_mwh / 100.0);
  add_value(text, "bess_price_age_seconds", "gauge", "Age of that price at the decision.",
            r.price_age_s);
}

void add_bus(const BatteryCounters& c, TextBuffer& text) {
  const char* const name = "bess_modbus_requests_total";
  add_head(text, name, "counter", "Modbus requests to the battery.");
  text.add("%s{result=\"ok\"} %lld\n", name, as_long(c.requests - c.failed_requests));
  text.add("%s{result=\"failed\"} %lld\n", name, as_long(c.failed_requests));
  add_value(text, "bess_modbus_reconnects_total", "counter", "Connections opened to the battery.",
            static_cast<double>(c.reconnects));
  add_value(text, "bess_register_writes_total", "counter",
            "Write requests that reached the battery.", static_cast<double>(c.register_writes));
}

void add_guard_and_state(const RunTotals& t, TextBuffer& text) {
  const char* const rule = "bess_guard_interventions_total";
  add_head(text, rule, "counter", "Cycles in which this rule overruled the student.");
  for (int i = 0; i < kReasonCount; ++i) {
    if (static_cast<Reason>(i) == Reason::kStudent) continue;  // no intervention
    text.add("%s{rule=\"%s\"} %lld\n", rule, reason_name(static_cast<Reason>(i)).data(),
             as_long(t.cycles_by_reason[static_cast<std::size_t>(i)]));
  }
  const char* const state = "bess_state";
  add_head(text, state, "gauge", "1 for the mode that the controller is in.");
  for (int i = 0; i < kModeCount; ++i) {
    const Mode mode = static_cast<Mode>(i);
    text.add("%s{state=\"%s\"} %d\n", state, mode_name(mode).data(), t.last.mode == mode ? 1 : 0);
  }
}

void add_run(const RunTotals& t, TextBuffer& text) {
  const CycleRecord& r = t.last;
  add_value(text, "bess_cycle_duration_seconds", "gauge",
            "From the begin of the decision to the order read back, last cycle.",
            1e-6 * r.decision_us + 1e-6 * r.write_us);
  add_value(text, "bess_last_cycle_timestamp_seconds", "gauge", "Tick of the last cycle, UTC.",
            static_cast<double>(r.utc_s));
  add_value(text, "bess_cycles_total", "counter", "Cycles since the start.",
            static_cast<double>(t.cycles));
  add_value(text, "bess_missed_ticks_total", "counter", "Ticks skipped because a cycle overran.",
            r.missed_ticks);
  add_value(text, "bess_deadline_misses_total", "counter",
            "Cycles whose order was not in force in time.", r.deadline_misses);
  add_value(text, "bess_unanswered_orders", "gauge",
            "Orders in a row that the battery did not answer with power.", r.unanswered_orders);
  add_value(text, "bess_full_cycles_today", "gauge",
            "Full cycles that orders have moved on this local day.",
            r.throughput.soc_moved_e4 / 20'000.0);
  add_value(text, "bess_log_records_dropped_total", "counter",
            "Records lost because the disk was too slow.", static_cast<double>(t.records_dropped));
  add_value(text, "bess_log_failures_total", "counter", "Records that a log file refused.",
            static_cast<double>(t.disk_failures));
}

}  // namespace

void RunTotals::count(const CycleRecord& record) {
  last = record;
  ++cycles;
  ++cycles_by_reason[static_cast<std::size_t>(record.reason)];
  if (record.written) ++written_orders;
  if (record.battery_status != Status::kOk) ++battery_failures;
  const bool has_asked = record.mode != Mode::kStopping;  // the last record asks for no price
  if (has_asked && record.price.status != Status::kOk) ++price_failures;
}

void format_status_json(const RunIdentity& identity, const RunTotals& totals,
                        std::int64_t written_monotonic_ns, TextBuffer& json) {
  json.add("{\n");
  add_identity(identity, json);
  json.add("  \"written_monotonic_ms\": %lld,\n", as_long(written_monotonic_ns / 1'000'000));
  add_last_cycle(totals.last, json);
  add_totals(totals, json);
  json.add("}\n");
}

void format_prometheus(const RunIdentity& identity, const RunTotals& totals, TextBuffer& text) {
  add_battery_and_price(totals.last, text);
  add_bus(totals.last.counters, text);
  add_guard_and_state(totals, text);
  add_run(totals, text);
  add_head(text, "bess_model_info", "gauge", "The student and the program that decide.");
  text.add("bess_model_info{version=\"%s\",student=\"%08x\",provenance=\"%s\",map=\"%s\"} 1\n",
           identity.version.c_str(), identity.student_hash,
           quotable(identity.student_provenance).c_str(), quotable(identity.map).c_str());
}

}  // namespace bess
