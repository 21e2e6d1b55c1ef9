// The prices commands as a user runs them.
#include <gmock/gmock.h>

#include "tests/support/market_test_support.h"
#include "tests/support/tokens.h"
#include "tests/support/train_commands.h"

namespace bess {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

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
