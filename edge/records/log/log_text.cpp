#include "edge/records/log/log_text.h"

#include "edge/records/log/record_fields.h"
#include "edge/records/log/text_buffer.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr auto kJournalFields = in_order<kRecordFields, &Places::journal>();
constexpr auto kCsvFields = in_order<kRecordFields, &Places::csv>();

/// A missing name or time is "none"; a number is printed as it is.
void add_value(const Field<CycleRecord>& field, const CycleRecord& record, TextBuffer& text) {
  const std::int64_t value = field.access.read(record);
  switch (field.access.kind) {
    case MemberKind::kNumber:
    case MemberKind::kFlag:
      return text.add("%lld", static_cast<long long>(value));
    case MemberKind::kUtc:
      return text.add("%s", field.exists_in(record) ? utc_text(value).c_str() : "none");
    case MemberKind::kName:
      return text.add("%s", field.exists_in(record) ? field.access.name_of(value) : "none");
  }
}

}  // namespace

std::size_t format_log_line(const CycleRecord& record, char (&line)[kLogLineBytes]) {
  TextBuffer text(line);
  const char* separator = "";
  for (const auto* field : kJournalFields) {
    text.add("%s%s=", separator, field->name_in(&Places::journal));
    add_value(*field, record, text);
    separator = " ";
  }
  return text.view().size();
}

std::size_t format_short_line(const CycleRecord& record, char (&line)[kLogLineBytes]) {
  TextBuffer text(line);
  text.add("%s  %10d  ", local_text(record.utc_s).c_str(), record.ordered_power_w);
  if (record.price.has_row) {
    text.add("%13.2f  ", eur_of(record.price.price_centi_eur_per_mwh));
  } else {
    text.add("%13s  ", "-");
  }
  if (record.has_measurement) {
    text.add("%6.1f", record.measurement.soc_e4 / 100.0);
  } else {
    text.add("%6s", "-");
  }
  text.add("  %s%s", reason_name(record.reason).data(), record.written ? "" : " (not written)");
  return text.view().size();
}

std::size_t format_csv_header(char (&line)[kLogLineBytes]) {
  TextBuffer text(line);
  const char* separator = "";
  for (const auto* field : kCsvFields) {
    text.add("%s%s", separator, field->name_in(&Places::csv));
    separator = ",";
  }
  return text.view().size();
}

std::size_t format_csv_line(const CycleRecord& record, char (&line)[kLogLineBytes]) {
  TextBuffer text(line);
  const char* separator = "";
  for (const auto* field : kCsvFields) {
    text.add("%s", separator);
    add_value(*field, record, text);
    separator = ",";
  }
  return text.view().size();
}

}  // namespace bess
