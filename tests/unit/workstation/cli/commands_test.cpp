// Output and files of evaluate.
#include <gmock/gmock.h>

#include <filesystem>

#include "shared/host/file.h"
#include "tests/support/market_test_support.h"
#include "tests/support/output_of_command.h"
#include "tests/support/small_market.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/train_commands.h"

namespace bess {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class EvaluateCli : public testing::Test {
 protected:
  EvaluateCli() { write_minute_file(prices_, small_series(), ""); }

  /// Standard output of `bess-train evaluate --prices <file> ARGUMENTS`.
  std::string output(const std::string& arguments) {
    return output_of_command("evaluate --prices " + prices_.string() + " " + arguments).output;
  }
  static std::vector<std::string> lines(const std::string& text) {
    std::vector<std::string> out;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = text.find('\n', at);
      out.push_back(text.substr(at, end - at));
      at = end + 1;
    }
    return out;
  }

  TemporaryFolder folder_;
  std::filesystem::path prices_ = folder_.file("prices.csv.gz");
};

TEST_F(EvaluateCli, ProfitAtTheReferenceWearIsThatOfARunWithIt) {
  const auto config = [&](const char* name, const char* text) {
    return " --config " + folder_.write(name, text);
  };
  const auto number = [](const std::string& line, const char* key) {
    const std::size_t at = line.find(key);
    return at == std::string::npos ? NAN : std::stod(line.substr(line.find(':', at) + 1));
  };
  const auto at_10 =
      output("--policy rbc --json" + config("a", "[battery]\nwear_eur_per_mwh = 10\n"));
  const double expected = number(at_10, "\"profit_eur_per_day_per_mwh\"");
  EXPECT_EQ(number(at_10, "\"profit_at_wear_10"), expected);
  for (const std::string& other :
       {std::string(), config("b", "[battery]\nwear_eur_per_mwh = 25\n")}) {
    EXPECT_NEAR(number(output("--policy rbc --json" + other), "\"profit_at_wear_10"), expected,
                1e-3);
  }
}

TEST_F(EvaluateCli, FilesHoldEveryPolicy) {
  const auto file = [&](const char* name) { return folder_.file(name); };
  output("--policy rbc rbc:60:140 --csv " + file("t.csv") + " --days-out " + file("d.csv") +
         " --steps-out " + file("s.csv"));
  const auto table = lines(read_file(file("t.csv")));
  EXPECT_EQ(table.size(), 1U + 4U);
  const auto days = lines(read_file(file("d.csv")));
  EXPECT_EQ(days[0], "date,profit_eur,cycles,switches,policy,carry_soc,soc_end_frac");
  const std::size_t test_days = 6 + 3;  // of January and February 2023
  EXPECT_EQ(days.size(), 1 + 4 * test_days);
  EXPECT_THAT(days.back(), HasSubstr(",rbc:60:140,true,"));
  EXPECT_EQ(lines(read_file(file("s.csv"))).size(), 1 + 4 * test_days * 720);
}

TEST_F(EvaluateCli, FitDelayChangesWhatIsFittedAndNothingElse) {
  EXPECT_EQ(output("--policy rbc --json --fit-delay 3"), output("--policy rbc --json"));
  EXPECT_NE(output("--policy tabular --json --fit-delay 3"), output("--policy tabular --json"));
}

TEST_F(EvaluateCli, OneDayOfTheSplitKeepsTheSocThatWasCarriedIntoIt) {
  const auto split_days = folder_.file("split.csv");
  const auto one_day = folder_.file("day.csv");
  output("--policy rbc tabular --days-out " + split_days);
  const std::string whole = read_file(split_days);
  const std::string last_line = whole.substr(whole.rfind('\n', whole.size() - 2) + 1);
  const std::string date = last_line.substr(0, last_line.find(','));
  output("--policy rbc tabular --date " + date + " --days-out " + one_day);
  EXPECT_THAT(read_file(one_day), HasSubstr(last_line));
  EXPECT_EQ(lines(read_file(one_day)).size(), 1U + 2U * 2U);  // policies times accounting modes
  EXPECT_THAT(output("--policy rbc --json --date " + date),
              HasSubstr(R"("profit_standard_error":null)"));  // one day gives no spread
}

TEST_F(EvaluateCli, FittedThresholdsAreReported) {
  EXPECT_THAT(output("--policy rbc-quartile"), Names("rbc-quartile: 23.6304 189.462"));
  EXPECT_THAT(output("--policy rbc --json"), Names("11 179 EUR/MWh"));
}

// The prices commands as a user runs them.

constexpr const char* kEntsoeDocument =
    "<Balancing_MarketDocument><TimeSeries><curveType>A01</curveType><Period><timeInterval>"
    "<start>2023-01-01T00:00Z</start><end>2023-01-01T00:15Z</end></timeInterval>"
    "<resolution>PT15M</resolution><Point><position>1</position>"
    "<imbalance_Price.amount>5</imbalance_Price.amount></Point></Period></TimeSeries>"
    "</Balancing_MarketDocument>";
constexpr const char* kEliaQuarterHour =
    "datetime;resolutioncode;imbalanceprice\n2023-01-01T00:15:00Z;PT15M;-30.258\n";

class PricesCli : public TrainCommands {
 protected:
  static std::string said(std::vector<std::string> arguments, int exit_code = 0) {
    arguments.insert(arguments.begin(), "prices");
    return TrainCommands::said(std::move(arguments), exit_code);
  }
};

TEST_F(PricesCli, ImportNamesTheSource) {
  const std::string entsoe = written("a85.xml", kEntsoeDocument);
  const std::string elia = written("ods134.csv", kEliaQuarterHour);
  EXPECT_THAT(said({"import", entsoe, "--out", path("entsoe.csv")}),
              AllOf(Names("ENTSO-E"), Not(Names("Elia"))));
  EXPECT_THAT(read_file(path("entsoe.csv")), AllOf(Names("ENTSO-E"), Not(Names("Elia"))));
  said({"import", entsoe, elia, "--out", path("both.csv")});
  EXPECT_THAT(read_file(path("both.csv")),
              Names("a85.xml ods134.csv ENTSO-E Elia opendata.elia.be CC BY 4.0 -30.258"));
  said({"reconstruct", "--quarter-hours", entsoe, elia, "--out", path("minutes.csv")});
  EXPECT_THAT(read_file(path("minutes.csv")),
              Names("a85.xml ods134.csv Elia ENTSO-E -30.258,-30.258"));
}

TEST_F(PricesCli, ReconstructReadsWhatImportAndSimulateWrote) {
  const std::string elia = written("ods134.csv", kEliaQuarterHour);
  said({"import", elia, "--out", path("imported.csv.gz")});
  EXPECT_THAT(
      said({"reconstruct", "--quarter-hours", path("imported.csv.gz"), "--out", path("drawn.csv")}),
      Names("drawn.csv 1 Elia"));
  EXPECT_THAT(read_file(path("drawn.csv")), Names("Elia opendata.elia.be -30.258,-30.258"));

  said({"simulate", "--days", "1", "--out", path("s.csv")});
  EXPECT_THAT(said({"reconstruct", "--quarter-hours", path("s.csv"), "--out", path("d.csv")}),
              Names("d.csv 96 1440 bess-train"));

  const std::string unsettled =
      written("m.csv", "minute_utc,indicative_eur_mwh,settled_eur_mwh\n2023-01-01T00:00:00Z,5,\n");
  EXPECT_THAT(said({"reconstruct", "--quarter-hours", unsettled, "--out", path("n.csv")}, 1),
              Names("m.csv ods047 ods134"));
}

TEST_F(PricesCli, SimulateSaysItsSeedAndSpan) {
  EXPECT_THAT(said({"simulate", "--days", "1", "--seed", "2", "--out", path("s.csv")}),
              Names("s.csv 1 2023-01-01 2 1440"));
}

TEST_F(PricesCli, OwnQuarterHoursLeadToMinutes) {
  const std::string own = written("own.csv",
                                  "Date;Price [EUR/MWh]\r\n01/06/2025 00:00;-1,5\r\n"
                                  "01/06/2025 00:15;2\r\n");
  EXPECT_THAT(said({"import", own, "--out", path("q.csv")}, 1), Names("own.csv:2 --date-format"));
  std::vector<std::string> import{"import", own, "--date-format", "dd/mm/yyyy", "--out"};
  import.push_back(path("q.csv"));
  EXPECT_THAT(said(import, 1), Names("own.csv:2 --time-zone"));
  import.insert(import.end(), {"--time-zone", "local"});
  EXPECT_THAT(said(import),
              Names("prices reconstruct --quarter-hours " + path("q.csv") + " --out"));
  EXPECT_THAT(read_file(path("q.csv")), AllOf(HasSubstr("\n2025-05-31T22:00:00Z,,-1.5\n"),
                                              HasSubstr("\n2025-05-31T22:29:00Z,,2\n")));
  said({"reconstruct", "--quarter-hours", path("q.csv"), "--out", path("m.csv")});
}

}  // namespace
}  // namespace bess
