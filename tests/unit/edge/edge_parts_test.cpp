// Small parts of the edge: built-in student, ticks, log lines.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "edge/core/control/policy.h"
#include "edge/core/loop/control_loop.h"
#include "edge/records/log/log_text.h"

namespace bess {
namespace {

TEST(BuiltInStudent, ComputesEverySelfCheckOfItsHeader) {
  EXPECT_GT(student_self_check_count(), 0);
  EXPECT_EQ(count_student_self_check_failures(), 0);
}

TEST(Ticks, AreOnTheTwoMinuteGridStrictlyAhead) {
  EXPECT_EQ(next_tick_utc_s(0), 120);
  EXPECT_EQ(next_tick_utc_s(119), 120);
  EXPECT_EQ(next_tick_utc_s(120), 240);
}

TEST(LogText, CsvLineHasAsManyFieldsAsItsHeader) {
  CycleRecord record;
  record.utc_s = 1'679'788'800;
  record.price.has_row = true;
  record.price.minute_utc_s = 1'679'788'740;
  char line[kLogLineBytes];
  const std::string csv(line, format_csv_line(record, line));
  const std::string header(line, format_csv_header(line));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), ','), std::count(header.begin(), header.end(), ','));
  EXPECT_TRUE(csv.starts_with("2023-03-26T00:00:00Z,0,start,2023-03-25T23:59:00Z,")) << csv;
}

}  // namespace
}  // namespace bess
