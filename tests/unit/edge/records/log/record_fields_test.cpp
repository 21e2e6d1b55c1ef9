// Field table against its outputs: each field is in every output that it claims, under its name and
// with its own value, and in no other.
#include "edge/records/log/record_fields.h"

#include <gmock/gmock.h>

#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "edge/records/log/log_text.h"
#include "edge/records/log/record_codec.h"
#include "shared/utc_text.h"
#include "tests/support/csv_rows.h"

namespace bess {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Names of the codes from 0, as older versions have written them. New ones are appended.
template <typename Enum>
void expect_codes(const std::vector<std::string>& names) {
  ASSERT_EQ(static_cast<int>(names.size()), count_of(Enum{}));
  for (std::size_t code = 0; code < names.size(); ++code) {
    EXPECT_EQ(name_of_code<Enum>(static_cast<std::int64_t>(code)), names[code]);
  }
}

TEST(RecordCodes, AreThoseOfOldLogs) {
  expect_codes<Mode>({"start", "running", "holding", "safe", "stopping"});
  expect_codes<Action>({"discharge", "idle", "charge"});
  expect_codes<OutlookSource>({"none", "planned", "usual", "late", "missing"});
  expect_codes<Status>({"ok",          "not_connected",   "timeout",      "bus_exception",
                        "bus_busy",    "not_permitted",   "bad_reply",    "implausible",
                        "not_applied", "not_expressible", "write_budget", "name_unresolved",
                        "tls_refused", "http_error",      "malformed",    "no_row",
                        "too_large",   "no_memory",       "too_late",     "server_busy",
                        "no_fetcher",  "other_version",   "doubtful_unit"});
}

/// Only the flags without which a value does not exist.
CycleRecord bare_record() {
  CycleRecord r;
  r.has_measurement = r.price.has_row = r.has_student_action = r.is_tripped = r.hold.held = true;
  r.site.has_grid_power = true;
  r.outlook.source = OutlookSource::kPlanned;
  return r;
}

/// A value that no other field of a bare record has.
std::int64_t telling_value(MemberKind kind) {
  switch (kind) {
    case MemberKind::kNumber:
      return 4'711;
    case MemberKind::kFlag:
      return 1;
    case MemberKind::kUtc:
      return 1'679'788'800;
    case MemberKind::kName:
      break;
  }
  return 2;
}

template <typename Source>
std::string value_text_of(const Field<Source>& field) {
  const std::int64_t value = telling_value(field.access.kind);
  if (field.access.kind == MemberKind::kUtc) return utc_text(value).c_str();
  return field.access.kind == MemberKind::kName ? field.access.name_of(value)
                                                : std::to_string(value);
}

template <typename Source>
std::string json_text_of(const Field<Source>& field) {
  if (field.access.kind == MemberKind::kFlag) return "true";
  return field.access.kind == MemberKind::kNumber ? value_text_of(field)
                                                  : '"' + value_text_of(field) + '"';
}

std::string status_of(const RunTotals& totals) {
  char storage[kStatusBytes];
  TextBuffer json(storage);
  format_status_json({.identity = {}, .totals = totals}, json);
  return std::string(json.view());
}

/// The text of one section of status.json.
std::string section_of(const std::string& status, const std::string& name) {
  const std::size_t begin = status.find("  \"" + name + "\": {");
  return status.substr(begin, status.find("\n  }", begin) - begin);
}

template <typename Source>
void expect_in_status(const Field<Source>& field, const RunTotals& totals) {
  const std::string status = status_of(totals);
  const std::pair<const char*, Output> sections[] = {{"last", &Places::last},
                                                     {"totals", &Places::totals}};
  for (const auto& [name, output] : sections) {
    const std::string key = std::string("\"") + field.name_in(output) + "\": ";
    const std::string section = section_of(status, name);
    if (field.place_in(output) == 0) {
      EXPECT_THAT(section, Not(HasSubstr(key)));
    } else {
      EXPECT_THAT(section, HasSubstr(key + json_text_of(field)));
    }
  }
}

template <typename Source>
void expect_in_metrics(const Field<Source>& field, const RunTotals& totals) {
  if (field.place_in(&Places::metrics) == 0) return;
  char storage[kMetricsBytes];
  TextBuffer text(storage);
  format_prometheus({.identity = {}, .totals = totals}, text);
  const double value = static_cast<double>(telling_value(field.access.kind)) / field.metric.divisor;
  std::ostringstream line;
  line.precision(10);
  line << '\n' << field.name_in(&Places::metrics) << "{battery=\"\"} " << value << '\n';
  EXPECT_THAT(std::string(text.view()), HasSubstr(line.str()));
}

void expect_in_journal(const Field<CycleRecord>& field, const CycleRecord& record) {
  char line[kLogLineBytes];
  const std::string journal = " " + std::string(line, format_log_line(record, line)) + " ";
  const std::string key = std::string(" ") + field.name_in(&Places::journal) + "=";
  if (field.place_in(&Places::journal) == 0) {
    EXPECT_THAT(journal, Not(HasSubstr(key)));
  } else {
    EXPECT_THAT(journal, HasSubstr(key + value_text_of(field) + " "));
  }
}

void expect_in_csv(const Field<CycleRecord>& field, const CycleRecord& record) {
  char line[kLogLineBytes];
  const auto names = split_csv_line(std::string(line, format_csv_header(line)));
  const auto values = split_csv_line(std::string(line, format_csv_line(record, line)));
  ASSERT_EQ(names.size(), values.size());
  const int column = field.place_in(&Places::csv);
  if (column == 0) {
    EXPECT_THAT(names, Not(::testing::Contains(field.name_in(&Places::csv))));
    return;
  }
  ASSERT_LE(static_cast<std::size_t>(column), names.size()) << "a column was left out";
  EXPECT_EQ(names[static_cast<std::size_t>(column) - 1], field.name_in(&Places::csv));
  EXPECT_EQ(values[static_cast<std::size_t>(column) - 1], value_text_of(field));
}

void expect_in_ring(const Field<CycleRecord>& field, const CycleRecord& record) {
  RecordBytes bytes;
  encode_record(record, 1, bytes);
  CycleRecord back;
  std::uint64_t number = 0;
  ASSERT_TRUE(decode_record(bytes, back, number));
  EXPECT_EQ(field.access.read(back), telling_value(field.access.kind));
}

/// Convertible to any member: counts the members of an aggregate.
struct AnyMember {
  template <typename Member>
  operator Member() const;  // NOLINT: implicit on purpose, never called
};

template <typename Aggregate, typename... Members>
consteval std::size_t count_members() {
  if constexpr (requires { Aggregate{Members{}..., AnyMember{}}; }) {
    return count_members<Aggregate, Members..., AnyMember>();
  } else {
    return sizeof...(Members);
  }
}

/// For a record whose members of these types are records themselves.
template <typename... Parts>
consteval std::size_t count_leaves() {
  return count_members<CycleRecord>() - sizeof...(Parts) + (count_members<Parts>() + ...);
}

TEST(RecordFields, NoMemberOfTheRecordIsForgotten) {
  constexpr std::size_t kLeaves =
      count_leaves<BatteryMeasurement, PriceReport, DayThroughput, BatteryCounters, PriceLevel,
                   Trip, ReversalHistory, HoldReport, SiteReport, MeterTrust, LostOrderHistory,
                   UnchangedPrice, ResponseFindings, FollowedOrder, OutlookReport,
                   PricedQuarterHour, PricedQuarterHour>();
  constexpr std::size_t kElsewhere =
      2;  // the battery's own grid meter: its used values are in `site`
  EXPECT_EQ(std::size(kRecordFields), kLeaves - kElsewhere);
}

TEST(RecordFields, EachIsInEveryOutputThatItClaims) {
  for (const auto& field : kRecordFields) {
    SCOPED_TRACE(field.name);
    CycleRecord record = bare_record();
    ASSERT_TRUE(field.access.set(record, telling_value(field.access.kind)));
    RunTotals totals;
    totals.last = record;
    expect_in_ring(field, record);
    expect_in_journal(field, record);
    expect_in_csv(field, record);
    expect_in_status(field, totals);
    expect_in_metrics(field, totals);
  }
}

TEST(RunFields, EachIsInEveryOutputThatItClaims) {
  for (const auto& field : kRunFields) {
    SCOPED_TRACE(field.name);
    RunTotals totals;
    ASSERT_TRUE(field.access.set(totals, telling_value(field.access.kind)));
    expect_in_status(field, totals);
    expect_in_metrics(field, totals);
  }
}

/// Two fields at one place of a table do not compile; this compares the tables.
TEST(RecordFields, PlacesAndNamesOfAnOutputAreTakenOnce) {
  for (const Output output :
       {&Places::journal, &Places::csv, &Places::last, &Places::totals, &Places::metrics}) {
    std::set<int> places;
    std::set<std::string> names;
    const auto take = [&](const auto& field) {
      if (field.place_in(output) == 0) return;
      EXPECT_TRUE(places.insert(field.place_in(output)).second) << field.name;
      EXPECT_TRUE(names.insert(field.name_in(output)).second) << field.name;
    };
    for (const auto& field : kRecordFields) take(field);
    for (const auto& field : kRunFields) take(field);
    EXPECT_FALSE(names.contains(""));
  }
}

}  // namespace
}  // namespace bess
