// What is written of a decision record, to the byte: ring, journal, CSV, status.json and metrics.
// Rings and CSV files outlive the program that wrote them, and others read status and metrics by
// name: a difference is a change of format. Rewrite with the command in the golden file's first
// line.
#include <gtest/gtest.h>

#include <sstream>

#include "edge/records/log/log_text.h"
#include "edge/records/log/record_codec.h"
#include "edge/records/log/run_status.h"
#include "tests/support/golden_file.h"
#include "tests/unit/edge/records/log/sample_records.h"

namespace bess {
namespace {

constexpr const char* kGoldenPath = BESS_SOURCE_DIR "/tests/data/golden/decision_records.txt";

void add_ring(const CycleRecord& record, std::ostream& out) {
  RecordBytes bytes;
  encode_record(record, 0x0102030405060708, bytes);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    char hex[4];
    std::snprintf(hex, sizeof hex, "%02x", bytes[i]);
    out << (i % 64 == 0 ? "\nring " : "") << hex;
  }
  out << '\n';
}

void add_lines(const char* name, const CycleRecord& record, std::ostream& out) {
  char line[kLogLineBytes];
  out << "== " << name;
  add_ring(record, out);
  out << "journal " << std::string_view(line, format_log_line(record, line)) << '\n';
  out << "csv " << std::string_view(line, format_csv_line(record, line)) << '\n';
}

void add_files(const CycleRecord& last, std::ostream& out) {
  char status[kStatusBytes];
  TextBuffer json(status);
  const RunStatus now{
      .identity = sample_identity(), .totals = full_totals(last), .written_monotonic_ms = 5'000};
  format_status_json(now, json);
  char metrics[kMetricsBytes];
  TextBuffer prometheus(metrics);
  format_prometheus(now, prometheus);
  EXPECT_FALSE(json.was_cut() || prometheus.was_cut());
  out << "status.json\n" << json.view() << "metrics.prom\n" << prometheus.view();
}

std::string golden_text() {
  std::ostringstream out;
  char header[kLogLineBytes];
  out << "# generator edge_test, version 1, no seed, command: BESS_UPDATE_GOLDEN=1 edge_test "
         "--gtest_filter=DecisionRecord.Golden*\n"
      << "csv header " << std::string_view(header, format_csv_header(header)) << '\n';
  CycleRecord unmeasured = full_record(1);
  unmeasured.has_measurement = false;
  CycleRecord unpriced = full_record(2);
  unpriced.price.has_row = unpriced.has_student_action = false;
  const std::pair<const char*, CycleRecord> records[] = {{"no cycle yet", CycleRecord{}},
                                                         {"full", full_record(7)},
                                                         {"no measurement", unmeasured},
                                                         {"no price, no student", unpriced},
                                                         {"longest", longest_record()}};
  for (const auto& [name, record] : records) {
    add_lines(name, record, out);
    add_files(record, out);
  }
  for (int i = 0; i < kReasonCount; ++i) {
    add_lines("enumerators", record_with_enumerators(i), out);
  }
  return out.str();
}

TEST(DecisionRecord, GoldenBytes) { expect_golden(kGoldenPath, golden_text()); }

}  // namespace
}  // namespace bess
