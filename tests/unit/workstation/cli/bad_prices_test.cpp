// Price files that every command must refuse, each through the program: one clear line that names
// the file, exit code 1 or 2, and no crash.
#include <gmock/gmock.h>

#include "tests/support/market_test_support.h"
#include "tests/support/price_cases.h"
#include "tests/support/tokens.h"
#include "tests/support/train_commands.h"

namespace bess {
namespace {

using testing::HasSubstr;
using testing::Not;

class BadPrices : public TrainCommands {
 protected:
  std::string evaluated(const std::string& text, int exit_code,
                        const std::string& accept = "") const {
    std::vector<std::string> arguments{
        "evaluate", "--prices", written("prices.csv", text), "--policy", "rbc", "--split", "all"};
    if (!accept.empty()) arguments.insert(arguments.end(), {"--accept", accept});
    return said(arguments, exit_code);
  }
};

TEST_F(BadPrices, EachIsOneClearLine) {
  const std::vector<PriceCase> cases = bad_price_files();
  for (const PriceCase& c : cases) {
    SCOPED_TRACE(c.name);
    const std::string output = evaluated(c.text, 1);
    EXPECT_THAT(output, testing::AllOf(testing::StartsWith("bess-train: "), Names(c.names),
                                       Not(HasSubstr("\x1b"))));
    EXPECT_EQ(std::ranges::count(output, '\n'), 1) << output;
  }
}

TEST_F(BadPrices, TheOrdinaryFileRaisesNothing) {
  EXPECT_THAT(evaluated(ordinary_text(), 0), Not(Names("bess-train")));
}

TEST_F(BadPrices, TheRowIsNamed) {
  EXPECT_THAT(evaluated(with_prices(2000, "1e200", ""), 1),
              Names("prices.csv:2002 1e+200 100000 EUR/MWh --accept price-range"));
  EXPECT_THAT(evaluated("# from somewhere\n" + with_prices(2000, "", "-9999"), 1),
              Names("prices.csv:1998 -9999 --accept sentinel"));
}

TEST_F(BadPrices, WhatIsMeantIsAccepted) {
  const std::string quiet = scaled_text(0.03);
  evaluated(quiet, 1);
  EXPECT_THAT(evaluated(quiet, 0, "gaps,price-unit"), Names("prices.csv:2 4.8504 [price-unit]"));
  evaluated(quiet, 1, "price-range");
  EXPECT_THAT(evaluated(quiet, 2, "price-units"), Names("--accept \"price-units\" price-unit"));
}

TEST_F(BadPrices, WhatNoArithmeticHoldsIsNeverAccepted) {
  for (const char* policy : {"rbc-tuned", "tabular", "mpc", "sdp", "foresight"}) {
    SCOPED_TRACE(policy);
    const std::string prices = written("prices.csv", with_prices(2000, "", "1e200"));
    EXPECT_THAT(said({"evaluate", "--prices", prices, "--policy", policy, "--split", "all",
                      "--accept", "price-range"},
                     1),
                Names("prices.csv: 2023-01-02T08:15:00Z 1e+200 EUR/MWh"));
  }
}

TEST_F(BadPrices, EveryCommandLooks) {
  const std::string bad = written("bad.csv", with_prices(2000, "", "-9999"));
  const std::string out = path("out");
  const std::vector<std::vector<std::string>> commands{
      {"train", "--prices", bad, "--out", out},
      {"run", "--prices", bad, "--out", out},
      {"backtest", "--prices", bad, "--out", out},
      {"evaluate", "--prices", written("good.csv", ordinary_text()), "--fit", bad, "--split", "all",
       "--policy", "rbc-tuned"},
      {"prices", "import", bad, "--out", out},
      {"prices", "reconstruct", "--quarter-hours", bad, "--out", out}};
  for (const std::vector<std::string>& command : commands) {
    EXPECT_THAT(said(command, 1), Names("bad.csv:1997 -9999 --accept sentinel")) << command[1];
    EXPECT_FALSE(std::filesystem::is_regular_file(out));
  }
  EXPECT_THAT(said({"prices", "stats", bad}), Names(bad + ":1997 -9999 [sentinel]"));
}

/// Settled prices of Belgium, those of another country, and the limits of bids: in every command,
/// to the digit.
TEST_F(BadPrices, ExtremePricesPassThroughEveryCommand) {
  const struct {
    const char* price;
    bool is_told;
  } cases[] = {{"-999", false}, {"-25907.54", true}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.price);
    const std::string file = written("extreme.csv", with_prices(2000, c.price, c.price));
    const std::string imported = path("imported.csv");
    const std::string drawn = path("drawn.csv");
    const std::vector<std::vector<std::string>> commands{
        {"prices", "import", file, "--out", imported},
        {"prices", "reconstruct", "--quarter-hours", file, "--out", drawn},
        {"prices", "stats", file},
        {"evaluate", "--prices", file, "--policy", "rbc", "foresight", "compiled", "--split",
         "all"}};
    for (const std::vector<std::string>& command : commands) {
      const std::string output = said(command);
      EXPECT_THAT(output, Not(HasSubstr("[sentinel]")));
      const bool is_told = testing::Value(output, Names(std::string("15000 ") + c.price));
      EXPECT_EQ(is_told, c.is_told) << output;
    }
    EXPECT_THAT(read_file(imported), HasSubstr(fmt::format(",{0},{0}\n", c.price)));
    EXPECT_THAT(read_file(drawn), HasSubstr(fmt::format(",{0},{0}\n", c.price)));
  }
}

TEST_F(BadPrices, ABatteryThatCannotBeMeantIsRefused) {
  const std::string prices = written("prices.csv", ordinary_text());
  const struct {
    const char* keys;
    int exit_code;
    const char* names;
  } cases[] = {{"power_w = 5", 1, "[battery] power_w 5 100 5000000"},
               {"capacity_wh = 10", 1, "[battery] capacity_wh 10 100 10000000"},
               {"power_w = 5000", 1, "power_w 5000 capacity_wh 0.00063"},
               {"capacity_wh = 8000", 1, "capacity_wh 8000 5e+02 0.05 20"},
               {"power_w = 1e9", 1, "power_w 1e+09 kW MW"},
               {"charge_efficiency = 0.5", 0, "charge_efficiency 0.5 0.47"},
               {"charge_efficiency = 1\ndischarge_efficiency = 1", 0,
                "charge_efficiency discharge_efficiency 1.00"},
               {"power_w = 4000\ncapacity_wh = 8000", 0, "rbc"}};
  for (const auto& c : cases) {
    const std::string config = written("my.toml", std::string("[battery]\n") + c.keys + "\n");
    EXPECT_THAT(said({"evaluate", "--prices", prices, "--policy", "rbc", "--split", "all",
                      "--config", config},
                     c.exit_code),
                Names(c.names));
  }
}

TEST_F(BadPrices, MonthsWithoutATrainingDayAreNamed) {
  const std::string prices = written("prices.csv", ordinary_text());
  const std::string config = written("my.toml", "[train]\ncontext = \"month\"\n");
  EXPECT_THAT(
      run({"train", "--steps", "1", "--prices", prices, "--config", config, "--out", path("t.bin")})
          .output,
      Names("1 20 02 12 [train]"));
}

std::string minute_file(int from_day, int days, double shift = 0) {
  return ordinary_text([=](std::size_t m, const OrdinaryRow& r) {
    const int day = static_cast<int>(m) / 1440;
    if (day < from_day || day >= from_day + days) return std::string();
    return row_text(r, fmt::format("{}", r.indicative + shift), fmt::format("{}", r.settled));
  });
}

TEST_F(BadPrices, ImportJoinsMinuteFilesThatAgree) {
  const std::string late = written("late.csv", minute_file(1, 2));
  const std::string early = written("early.csv.gz", minute_file(0, 2));
  said({"prices", "import", late, early, "--out", path("both.csv")});
  const std::string text = read_file(path("both.csv"));
  EXPECT_EQ(text.substr(text.find("minute_utc")), ordinary_text());
  const std::string other = written("other.csv", minute_file(1, 2, 1));
  EXPECT_THAT(
      said({"prices", "import", late, other, "--out", path("none.csv")}, 1),
      Names("late.csv:2 " + other + " 2023-01-01T23:00:00Z 43.52 44.52 2880 --accept overlap"));
  EXPECT_FALSE(std::filesystem::exists(path("none.csv")));
  said({"prices", "import", late, other, "--accept", "overlap", "--out", path("later.csv")});
}

}  // namespace
}  // namespace bess
