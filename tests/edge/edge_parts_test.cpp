// The small parts of the edge: built-in student, time texts, log lines, containers.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "edge/base/static_vector.h"
#include "edge/control/policy.h"
#include "edge/log/log_text.h"
#include "edge/loop/control_loop.h"
#include "shared/fixed_text.h"
#include "shared/utc_text.h"
#include "tests/edge/log/sample_records.h"

namespace bess {
namespace {

TEST(BuiltInStudent, ComputesEverySelfCheckOfItsHeader) {
  EXPECT_GT(student_self_check_count(), 0);
  EXPECT_EQ(count_student_self_check_failures(), 0);
}

TEST(Ticks, LieOnTheTwoMinuteGridStrictlyAhead) {
  EXPECT_EQ(next_tick_utc_s(0), 120);
  EXPECT_EQ(next_tick_utc_s(119), 120);
  EXPECT_EQ(next_tick_utc_s(120), 240);
}

TEST(UtcText, RoundTripAndOffsets) {
  std::int64_t utc_s = 0;
  ASSERT_TRUE(parse_utc("2023-03-26T01:02:03Z", utc_s));
  EXPECT_EQ(utc_text(utc_s), "2023-03-26T01:02:03Z");
  std::int64_t same = 0;
  for (const char* text :
       {"2023-03-26T03:02:03+02:00", "2023-03-25T23:32:03-01:30", "2023-03-26T01:02:03.456Z"}) {
    ASSERT_TRUE(parse_utc(text, same)) << text;
    EXPECT_EQ(same, utc_s) << text;
  }
  ASSERT_TRUE(parse_utc("2023-03-26 01:02:03.000Z", same, kAlsoBlank));
  EXPECT_EQ(same, utc_s);
  ASSERT_TRUE(parse_utc("2024-02-29T00:00Z", same));
}

TEST(UtcText, RefusesWhatIsAmbiguousOrImpossible) {
  std::int64_t utc_s = 0;
  for (const char* text :
       {"", "2023", "2023-03-26", "2023-03-26T01:02:03", "2023-03-26 01:02:03Z",
        "2023-13-01T00:00:00Z", "2023-02-29T00:00:00Z", "2023-03-26T24:00:00Z",
        "2023-03-26T01:60:00Z", "2023-03-26T01:02:03+0200", "2023-03-26T01:02:03+99:00",
        "2023-03-26T01:02:03Zx", "2023-03-26T01:02:03.Z", "2023-03-26T01:02.5Z",
        "-023-03-26T01:02:03Z"}) {
    EXPECT_FALSE(parse_utc(text, utc_s)) << text;
  }
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

TEST(LogText, LongestLineFits) {
  const CycleRecord record = longest_record();
  char line[kLogLineBytes];
  EXPECT_LT(format_log_line(record, line), kLogLineBytes - 1);
  EXPECT_LT(format_csv_line(record, line), kLogLineBytes - 1);
}

TEST(StaticVector, RefusesWhatDoesNotFit) {
  StaticVector<int, 2> items;
  EXPECT_TRUE(items.try_push_back(1));
  EXPECT_TRUE(items.try_push_back(2));
  EXPECT_FALSE(items.try_push_back(3));
  EXPECT_EQ(items.size(), 2);
  EXPECT_DEATH(items.push_back(3), "CHECK failed");
  EXPECT_DEATH(static_cast<void>(items[2]), "CHECK failed");
}

TEST(FixedText, CutsAndSaysSo) {
  FixedText<3> text;
  EXPECT_TRUE(text.assign("abc"));
  EXPECT_FALSE(text.assign("abcd"));
  EXPECT_EQ(text, "abc");
  EXPECT_STREQ(text.c_str(), "abc");
}

}  // namespace
}  // namespace bess
