#include "edge/records/log/run_status.h"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <type_traits>
#include <utility>

#include "edge/records/log/atomic_file.h"
#include "edge/records/log/record_fields.h"
#include "shared/crc32.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

long long as_long(std::int64_t value) { return value; }
const char* as_bool(bool value) { return value ? "true" : "false"; }

/// Text for quotes in JSON and Prometheus: control characters become spaces, quotes apostrophes.
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
  json.add("  \"name\": \"%s\",\n", id.name.c_str());
  json.add("  \"version\": \"%s\",\n  \"student\": \"%08x\",\n  \"provenance\": \"%s\",\n",
           id.version.c_str(), id.student_hash, quotable(id.student_provenance).c_str());
  json.add("  \"trained_from\": \"%s\",\n  \"trained_until\": \"%s\",\n", id.trained_from.c_str(),
           id.trained_until.c_str());
  json.add("  \"context\": \"%s\",\n", id.context.c_str());
  json.add("  \"map\": \"%s\",\n  \"variant\": \"%s\",\n  \"battery\": \"%s\",\n",
           quotable(id.map).c_str(), quotable(id.variant).c_str(), quotable(id.battery).c_str());
  json.add("  \"control\": %s,\n  \"pid\": %d,\n  \"start_utc\": \"%s\",\n  \"cadence_ms\": %d,\n",
           as_bool(id.control), static_cast<int>(id.pid), utc_text(id.start_utc_s).c_str(),
           id.cadence_ms);
}

/// Visits fields of the run and of its last control cycle, in the order of one output.
template <Output kOutput, typename Visit>
void visit_in_order(const RunTotals& t, const Visit& visit) {
  constexpr auto kRun = in_order<kRunFields, kOutput>();
  std::size_t next = 0;
  for (const auto* field : in_order<kRecordFields, kOutput>()) {
    for (; next < kRun.size() && kRun[next]->place_in(kOutput) < field->place_in(kOutput); ++next) {
      visit(*kRun[next], t);
    }
    visit(*field, t.last);
  }
  for (; next < kRun.size(); ++next) visit(*kRun[next], t);
}

/// Numbers and times have a flag for their existence next to them; a missing name is "none".
template <typename Source>
void add_json_value(const Field<Source>& field, const Source& source, TextBuffer& json) {
  const std::int64_t value = field.access.read(source);
  switch (field.access.kind) {
    case MemberKind::kNumber:
      return json.add("%lld", as_long(value));
    case MemberKind::kFlag:
      return json.add("%s", as_bool(value != 0));
    case MemberKind::kUtc:
      return json.add("\"%s\"", utc_text(value).c_str());
    case MemberKind::kName:
      return json.add("\"%s\"", field.exists_in(source) ? field.access.name_of(value) : "none");
  }
}

template <Output kOutput>
void add_section(const char* name, const RunTotals& totals, TextBuffer& json) {
  json.add("  \"%s\": {", name);
  int line = 0;
  visit_in_order<kOutput>(totals, [&](const auto& field, const auto& source) {
    const int line_before = std::exchange(line, tens(field.place_in(kOutput)));
    json.add("%s%s", line_before == 0 ? "" : ",", line_before == line ? " " : "\n    ");
    json.add("\"%s\": ", field.name_in(kOutput));
    add_json_value(field, source, json);
  });
  json.add("\n  },\n");
}

void add_cycles_by_reason(const RunTotals& t, TextBuffer& json) {
  json.add("  \"cycles_by_reason\": {");
  for (int i = 0; i < kReasonCount; ++i) {
    json.add("%s\n    \"%s\": %lld", i == 0 ? "" : ",", reason_name(static_cast<Reason>(i)).data(),
             as_long(t.cycles_by_reason[static_cast<std::size_t>(i)]));
  }
  json.add("\n  }");
}

/// Metrics with the battery's name as a label, because several controllers may share a folder.
struct Metrics {
  TextBuffer& out;
  char label[80];
};

/// Names of counters end in _total, the naming rule of Prometheus.
void add_head(TextBuffer& text, const char* name, const char* help) {
  const bool is_counter = std::string_view(name).ends_with("_total");
  text.add("# HELP %s %s\n# TYPE %s %s\n", name, help, name, is_counter ? "counter" : "gauge");
}

void add_value(const Metrics& text, const char* name, const char* help, double value) {
  add_head(text.out, name, help);
  text.out.add("%s{%s} %.10g\n", name, text.label, value);
}

/// Metrics of one field each. A missing value is absent, not 0.
void add_fields(MetricGroup group, const RunTotals& totals, const Metrics& text) {
  visit_in_order<&Places::metrics>(totals, [&](const auto& field, const auto& source) {
    const bool is_due = tens(field.place_in(&Places::metrics)) == static_cast<int>(group);
    if (!is_due || !field.exists_in(source)) return;
    add_value(text, field.name_in(&Places::metrics), field.metric.help,
              static_cast<double>(field.access.read(source)) / field.metric.divisor);
  });
}

void add_requests(const BatteryCounters& c, const Metrics& text) {
  const char* const name = "bess_modbus_requests_total";
  add_head(text.out, name, "Modbus requests to the battery.");
  text.out.add("%s{%s,result=\"ok\"} %lld\n", name, text.label,
               as_long(c.requests - c.failed_requests));
  text.out.add("%s{%s,result=\"failed\"} %lld\n", name, text.label, as_long(c.failed_requests));
}

void add_interventions(const RunTotals& t, const Metrics& text) {
  const char* const name = "bess_guard_interventions_total";
  add_head(text.out, name, "Control cycles decided by this reason instead of the student alone.");
  for (int i = 0; i < kReasonCount; ++i) {
    if (static_cast<Reason>(i) == Reason::kStudent) continue;  // no intervention
    text.out.add("%s{%s,rule=\"%s\"} %lld\n", name, text.label,
                 reason_name(static_cast<Reason>(i)).data(),
                 as_long(t.cycles_by_reason[static_cast<std::size_t>(i)]));
  }
}

void add_state(Mode mode_now, const Metrics& text) {
  const char* const name = "bess_state";
  add_head(text.out, name, "1 for the mode that the controller is in.");
  for (int i = 0; i < kModeCount; ++i) {
    const Mode mode = static_cast<Mode>(i);
    text.out.add("%s{%s,state=\"%s\"} %d\n", name, text.label, mode_name(mode).data(),
                 mode == mode_now ? 1 : 0);
  }
}

void add_model(const RunIdentity& id, const Metrics& text) {
  const char* const name = "bess_model_info";
  add_head(text.out, name, "The student and the program that decide.");
  text.out.add("%s{%s,version=\"%s\",student=\"%08x\",provenance=\"%s\",map=\"%s\"} 1\n", name,
               text.label, id.version.c_str(), id.student_hash,
               quotable(id.student_provenance).c_str(), quotable(id.map).c_str());
}

/// Only values that the device reports.
void add_wear(const StorageWear& wear, const Metrics& text) {
  if (wear.used_life_percent > 0) {
    add_value(text, "bess_card_used_life_ratio",
              "Share of its life that the state folder's card has used, as of the start.",
              wear.used_life_percent / 100.0);
  }
  if (wear.spare_level > 0) {
    add_value(text, "bess_card_spare_level",
              "Spare blocks of that card: 1 normal, 2 most are used, 3 nearly all.",
              wear.spare_level);
  }
  if (wear.file_system_errors >= 0) {
    add_value(
        text, "bess_file_system_errors",
        "Errors that the kernel has counted in the state folder's file system, as of the start.",
        static_cast<double>(wear.file_system_errors));
  }
}

/// CRC of the memory image, padding included.
std::uint32_t crc_of(const RunStatus& status) { return crc32_of(&status, sizeof status); }

}  // namespace

void RunTotals::count(const CycleRecord& record) {
  const auto keep = [&](std::int64_t& since_utc_s, bool is_same) {
    if (cycles == 0 || !is_same) since_utc_s = record.utc_s;
  };
  keep(reason_since_utc_s, record.reason == last.reason);
  keep(battery_since_utc_s, record.battery_status == last.battery_status);
  keep(price_since_utc_s, record.price.status == last.price.status);
  last = record;
  ++cycles;
  ++cycles_by_reason[static_cast<std::size_t>(record.reason)];
  if (record.written) ++written_orders;
  if (record.battery_status != Status::kOk) ++battery_failures;
  const bool has_asked = record.mode != Mode::kStopping;  // the last record has no price request
  if (has_asked && record.price.status != Status::kOk) ++price_failures;
}

FixedText<511> stored_status_path(const FixedText<511>& status_json) {
  std::string_view stem = status_json.view();
  stem.remove_suffix(std::min(stem.size(), std::string_view("json").size()));
  char path[512];
  const int size =
      std::snprintf(path, sizeof path, "%.*sbin", static_cast<int>(stem.size()), stem.data());
  return FixedText<511>(std::string_view(path, static_cast<std::size_t>(size)));
}

bool write_status(const char* path, StoredStatus& stored) {
  stored.layout = kStatusLayout;
  stored.bytes = sizeof stored;
  stored.crc = crc_of(stored.status);
  return replace_or_remove_file(path, {reinterpret_cast<const char*>(&stored), sizeof stored});
}

StatusFile read_status(const char* path, RunStatus& status) {
  static_assert(std::is_trivially_copyable_v<RunStatus>);
  StoredStatus stored;
  const ssize_t size = read_beginning(path, {reinterpret_cast<char*>(&stored), sizeof stored},
                                      SymlinkPolicy::kFollowed);
  if (size < 0) return StatusFile::kAbsent;
  const bool is_ours =
      size == sizeof stored && stored.bytes == sizeof stored && stored.layout == kStatusLayout;
  if (!is_ours || stored.crc != crc_of(stored.status)) return StatusFile::kDamaged;
  status = stored.status;
  return StatusFile::kRead;
}

void format_status_json(const RunStatus& status, TextBuffer& json) {
  const RunTotals& totals = status.totals;
  json.add("{\n");
  add_identity(status.identity, json);
  json.add("  \"written_monotonic_ms\": %lld,\n", as_long(status.written_monotonic_ms));
  json.add("  \"log_number\": %llu,\n", static_cast<unsigned long long>(totals.log_number));
  add_section<&Places::last>("last", totals, json);
  add_section<&Places::totals>("totals", totals, json);
  add_cycles_by_reason(totals, json);
  json.add("%s", checksum_end(json.view(), kJsonChecksum).c_str());
}

void format_prometheus(const RunStatus& status, TextBuffer& out) {
  const RunIdentity& identity = status.identity;
  const RunTotals& totals = status.totals;
  Metrics text{.out = out, .label = ""};
  std::snprintf(text.label, sizeof text.label, "battery=\"%s\"", identity.name.c_str());
  const CycleRecord& last = totals.last;
  add_fields(MetricGroup::kSite, totals, text);
  add_requests(last.counters, text);
  add_fields(MetricGroup::kBus, totals, text);
  add_interventions(totals, text);
  add_state(last.mode, text);
  add_value(text, "bess_cycle_duration_seconds",
            "Time from the start of the decision until the order is read back, last control cycle.",
            1e-6 * last.decision_us + 1e-6 * last.write_us);
  add_fields(MetricGroup::kRun, totals, text);
  add_fields(MetricGroup::kPeople, totals, text);
  add_fields(MetricGroup::kConnection, totals, text);
  add_fields(MetricGroup::kOutlook, totals, text);
  add_model(identity, text);
  add_wear(identity.wear, text);
  out.add("%s", checksum_end(out.view(), kCommentChecksum).c_str());
}

}  // namespace bess
