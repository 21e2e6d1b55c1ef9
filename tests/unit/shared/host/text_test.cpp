// Fields with quotes, and the table with named columns.
#include "shared/host/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "shared/host/file.h"
#include "shared/host/minute_file.h"
#include "shared/host/text.h"
#include "tests/support/market_test_support.h"
#include "tests/support/temporary_folder.h"
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

// Identity of files under different names.

namespace fs = std::filesystem;

class DistinctFiles : public testing::Test {
 protected:
  DistinctFiles() { fs::create_directory(folder_.file("sub")); }

  static std::string refusal(const std::vector<NamedPath>& outputs,
                             const std::vector<NamedPath>& inputs) {
    return refusal_of([&] { require_distinct(outputs, inputs); });
  }

  TemporaryFolder folder_;
  std::string input_ = folder_.write("prices.csv", "prices");
};

TEST_F(DistinctFiles, AnOutputThatIsAnInputIsRefusedUnderAnyName) {
  const std::string link = folder_.file("link.csv");
  fs::create_symlink(input_, link);
  const std::string linked_folder = folder_.file("elsewhere");
  fs::create_directory_symlink(folder_.file(""), linked_folder);
  for (const std::string& name : {input_, link, folder_.file("sub/../prices.csv"),
                                  linked_folder + "/prices.csv", fs::relative(input_).string()}) {
    EXPECT_EQ(
        refusal({{"--out", name}}, {{"--config", ""}, {"--prices", input_}}),
        "--out " + name + ": would replace the input --prices " + input_ + "; use another name");
  }
}

TEST_F(DistinctFiles, TwoOutputsThatWillBeOneFileAreRefused) {
  const std::string later = folder_.file("later.csv");  // does not exist yet
  EXPECT_NE(refusal({{"--csv", later}, {"--days-out", folder_.file("sub/../later.csv")}}, {}), "");
}

TEST_F(DistinctFiles, OthersDevicesAndWhatIsNotGivenPass) {
  EXPECT_EQ(refusal({{"--csv", folder_.file("a.csv")}, {"--out", ""}, {"--curve-out", ""}},
                    {{"--prices", input_}, {"--config", ""}}),
            "");
  EXPECT_EQ(
      refusal({{"--csv", "/dev/null"}, {"--days-out", "/dev/null"}}, {{"--fit", "/dev/null"}}), "");
}

const std::vector<std::string> kWords = {"train", "distil", "verify", "--resume", "--prices"};

TEST(NearestWord, FindsWhatWasProbablyMeant) {
  EXPECT_EQ(nearest_word("tarin", kWords), "train") << "two letters swapped";
  EXPECT_EQ(nearest_word("distill", kWords), "distil") << "a letter too many";
  EXPECT_EQ(nearest_word("verfy", kWords), "verify") << "a letter missing";
  EXPECT_EQ(nearest_word("--resune", kWords), "--resume") << "another letter";
  EXPECT_EQ(nearest_word("--pri", kWords), "--prices") << "its beginning";
}

TEST(NearestWord, IsSilentAboutWhatIsFarFromAll) {
  EXPECT_EQ(nearest_word("backtest", kWords), "");
  EXPECT_EQ(nearest_word("x", kWords), "") << "too short to tell";
  EXPECT_EQ(nearest_word(std::string(100'000, 'a'), kWords), "");
  EXPECT_EQ(nearest_word("train", {}), "");
}

TEST(NearestWord, AsPartOfAMessage) {
  EXPECT_EQ(did_you_mean("tran", kWords), "; did you mean train?");
  EXPECT_EQ(did_you_mean("zzz", kWords), "");
}

// Minute files: what is written reads back to the same prices.

TEST(MinuteFile, PricesReadBackToTheLastDigit) {
  const MinuteSeries series{0, {-30.258, 0.1 + 0.2, 100}, {-999, 1e-7, std::nan("")}};
  const std::string text = format_minute_csv(series, "");
  EXPECT_THAT(text, testing::HasSubstr("1970-01-01T00:00:00Z,-30.258,-999\n"));
  const MinuteSeries read = parse_minute_csv(text, "written");
  EXPECT_EQ(read.indicative, series.indicative);
  EXPECT_EQ(read.settled[1], 1e-7);
}

TEST(MinuteFile, AByteOrderMarkIsSkipped) {
  const std::string text =
      "\xEF\xBB\xBFminute_utc,indicative_eur_mwh,settled_eur_mwh\n2023-01-01T00:00:00Z,1,2\n";
  EXPECT_EQ(parse_minute_csv(text, "f").settled.at(0), 2);
  EXPECT_THAT(
      user_error_of([] { (void)parse_minute_csv(std::string_view("\xFF\xFEm\0i\0", 6), "f"); }),
      Names("f UTF-16"));
}

TEST(MinuteFile, EmptyPricesCommentsAndGapsAreMissing) {
  const MinuteSeries series = parse_minute_csv(
      "# provenance\n"
      "minute_utc,indicative_eur_mwh,settled_eur_mwh\r\n"
      "\n"
      "2023-03-26T00:13:00Z,10.5,20\r\n"
      "2023-03-26T00:14:00Z,,20\n"
      "2023-03-26 01:16:00+01:00,-3.25,\n",
      "f");
  ASSERT_EQ(series.size(), 4U);
  EXPECT_EQ(series.indicative[0], 10.5);
  EXPECT_TRUE(std::isnan(series.indicative[1]));
  EXPECT_FALSE(series.is_empty(1));
  EXPECT_TRUE(series.is_empty(2));
  EXPECT_EQ(series.indicative[3], -3.25);
  EXPECT_TRUE(std::isnan(series.settled[3]));
}

TEST(MinuteFile, EveryMistakeNamesItsLine) {
  const std::string header = "minute_utc,indicative_eur_mwh,settled_eur_mwh\n";
  const std::pair<std::string, const char*> mistakes[] = {
      {"", "f"},
      {header, "f"},
      {header + "2023-01-01T00:00:00Z,,\n", "f"},
      {"time,price\n", "f:1 minute_utc"},
      {header + "yesterday,1,2\n", "f:2 \"yesterday,1,2\""},
      {header + "2023-01-01T00:00:30Z,1,2\n", "f:2"},
      {header + "2023-01-01T00:00:00Z,abc,2\n", "f:2 indicative"},
      {header + "2023-01-01T00:00:00Z,1,inf\n", "f:2 settled"},
      {header + "2023-01-01T00:00:00Z,1,2,3\n", "f:2"},
      {header + "#\n2023-01-01T00:01:00Z,1,2\n2023-01-01T00:00:00Z,1,2\n", "f:4"},
      {header + "2023-01-01T00:00:00Z,1,2\n2073-01-01T00:00:00Z,1,2\n",
       "f:3 2073-01-01T00:00:00Z 40"},
  };
  for (const auto& mistake : mistakes) {
    EXPECT_THAT(user_error_of([&] { static_cast<void>(parse_minute_csv(mistake.first, "f")); }),
                Names(mistake.second));
  }
}

}  // namespace
}  // namespace bess
