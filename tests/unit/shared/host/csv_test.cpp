// Fields with quotes, and the table with named columns.
#include "shared/host/csv.h"

#include <gmock/gmock.h>

#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"

namespace bess {
namespace {

std::vector<std::string> fields_of(std::string_view line, char separator) {
  std::vector<std::string> all;
  CsvFields fields(line, separator);
  for (std::string_view field; fields.take(field);) all.emplace_back(field);
  return all;
}

std::string csv_complaint(std::string_view text) {
  return user_error_of([&] {
    const CsvTable table(text, "f.csv");
    static_cast<void>(table.number(0, table.column("price")));
    static_cast<void>(table.utc_s(0, table.column("utc")));
  });
}

TEST(Csv, FieldsKeepSeparatorsInsideQuotes) {
  EXPECT_THAT(fields_of("a,\"b,c\",,d", ','), testing::ElementsAre("a", "b,c", "", "d"));
  EXPECT_THAT(fields_of("1,5;2", ';'), testing::ElementsAre("1,5", "2"));
  EXPECT_THAT(fields_of("", ','), testing::ElementsAre(""));
}

TEST(Csv, AFieldThatNeedsQuotesReadsBack) {
  const std::string text = "say \"no\", then\tgo";
  const CsvTable table("name\n" + csv_field(text) + "\n", "f.csv");
  EXPECT_EQ(table.text(0, 0), text);
}

TEST(Csv, TableIsReadByColumn) {
  const CsvTable table("\xEF\xBB\xBF# by hand\nutc,price\r\n2023-01-01T00:00:00Z,-2.5\r\n",
                       "f.csv");
  ASSERT_EQ(table.row_count(), 1U);
  EXPECT_EQ(table.number(0, table.column("price")), -2.5);
  EXPECT_EQ(table.utc_s(0, table.column("utc")), 1'672'531'200);
}

TEST(Csv, EveryMistakeNamesItsPlace) {
  EXPECT_THAT(csv_complaint("utc,price\n"), Names("f.csv"));
  EXPECT_THAT(csv_complaint("utc,price\n1\n"), Names("f.csv:2 1 2"));
  EXPECT_THAT(csv_complaint("utc,cost\n1,2\n"), Names("f.csv \"price\""));
  EXPECT_THAT(csv_complaint("utc,price\n# gap\nx,y\n"), Names("f.csv:3 price \"y\""));
  EXPECT_THAT(csv_complaint("utc,price\nx,1\n"), Names("f.csv:2 utc \"x\""));
}

}  // namespace
}  // namespace bess
