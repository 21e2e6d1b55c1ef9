// Earnings by battery size: a cell equals `evaluate` at its own size; money is shared, billed and
// paid back as by hand; an error of a plan is reported with its place.
#include <gmock/gmock.h>

#include <cmath>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/json.h"
#include "tests/support/output_of_command.h"
#include "tests/support/small_market.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/runs/size/size_cell.h"

namespace bess {
namespace {

std::string output_of(const std::string& arguments) { return output_of_command(arguments).output; }

/// Minutes [from, until) of `series` are missing.
void leave_out(MinuteSeries& series, std::int64_t from_utc_s, std::int64_t until_utc_s) {
  for (std::size_t m = 0; m < series.size(); ++m) {
    if (series.utc_s(m) < from_utc_s || series.utc_s(m) >= until_utc_s) continue;
    series.indicative[m] = series.settled[m] = kNotPublished;
  }
}

constexpr const char* kContract =
    "import_adder_eur_per_mwh = 12\nexport_percent = 5\nwear_eur_per_mwh = 6\n";

/// January to the 25th is the fit for February, by `size` and by `evaluate --fit`: a fold's
/// training days are then those of a file. By hour alone, because the trailing level would see
/// more.
TEST(Size, ACellIsWhatEvaluateCountsAtItsOwnSize) {
  const TemporaryFolder folder;
  MinuteSeries both = small_series();
  leave_out(both, local_midnight_utc_s({2023, 1, 26}), local_midnight_utc_s({2023, 2, 1}));
  MinuteSeries january = both;
  leave_out(january, local_midnight_utc_s({2023, 2, 1}), INT64_MAX);
  MinuteSeries february = both;
  leave_out(february, 0, local_midnight_utc_s({2023, 1, 26}) - 3600);
  write_minute_file(folder.file("both.csv.gz"), both, "");
  write_minute_file(folder.file("january.csv.gz"), january, "");
  write_minute_file(folder.file("february.csv.gz"), february, "");
  const std::string plan = folder.write(
      "plan.toml", std::string("[size]\npower_kw = [3, 6]\ncapacity_kwh = [6, 12]\nwindow_days = "
                               "31\npolicy = \"sdp-hour\"\n[[contract]]\nname = \"dear\"\n") +
                       kContract);
  const Json sized = Json::parse(output_of("size --json --prices " + folder.file("both.csv.gz") +
                                           " --plan " + plan + " --out " + folder.file("sizes")));
  EXPECT_EQ(sized.value()["classes"].number(), 3) << "1/2, 1 (twice) and 1/4 C";
  const JsonValue cells = sized.value()["cells"];
  ASSERT_EQ(cells.size(), 4U);
  const auto by_hand = [&](double power_w, double capacity_wh) {
    const std::string config =
        folder.write("cell.toml", "[battery]\npower_w = " + std::to_string(power_w) +
                                      "\ncapacity_wh = " + std::to_string(capacity_wh) +
                                      "\nwear_eur_per_mwh = 6\n[costs]\n" +
                                      "import_adder_eur_per_mwh = 12\nexport_percent = 5\n");
    const Json json = Json::parse(
        output_of("evaluate --json --split all --carry-soc --policy sdp-hour --prices " +
                  folder.file("february.csv.gz") + " --fit " + folder.file("january.csv.gz") +
                  " --config " + config));
    EXPECT_EQ(json.value()["days"].number(), 28);
    return json.value()["profit_eur_per_day_per_mwh"].number().value();
  };
  for (const JsonValue cell : cells) {
    const double power_w = 1e3 * cell["power_kw"].number().value();
    const double capacity_wh = 1e3 * cell["capacity_kwh"].number().value();
    const double profit = cell["profit_eur_per_day_per_mwh"].number().value();
    EXPECT_NEAR(profit, by_hand(8e6 * power_w / capacity_wh, 8e6), 1e-4) << "of its class";
    EXPECT_NEAR(profit / by_hand(power_w, capacity_wh), 1, 1e-4)
        << "its own size: values are floats, a decision between equals may fall otherwise";
  }
  const std::string csv = read_file(folder.file("sizes/size.csv"));
  EXPECT_EQ(CsvTable(csv, "size.csv").row_count(), 4U);
  EXPECT_THAT(read_file(folder.file("sizes/size.html")),
              testing::HasSubstr("<table id=\"map-1\">"));
  EXPECT_EQ(load_run_config(folder.file("sizes/best.toml")).battery.wear_eur_per_mwh, 6);
}

/// Two days a month: 2 and 4 EUR in May, -3 and 1 in June, of 1 MWh; 1 MWh through it each day.
SizeClass traded_by_hand(double wear_eur_per_mwh) {
  SizeClass by_hand;
  by_hand.battery.capacity_wh = 1e6;
  by_hand.traded.capacity_mwh = 1;
  by_hand.traded.wear_eur_per_mwh = wear_eur_per_mwh;
  const std::pair<const char*, double> days[] = {
      {"2024-05-01", 2}, {"2024-05-02", 4}, {"2024-06-01", -3}, {"2024-06-02", 1}};
  for (const auto& [date, eur] : days) {
    by_hand.traded.days.push_back({date, eur - wear_eur_per_mwh, 0.5, 1, 0.5});
    by_hand.traded.days.back().throughput_mwh = 1;
  }
  by_hand.peaks = {{"2024-05", 1}, {"2024-06", 0.5}};
  return by_hand;
}

TEST(Size, TheShareIsOfMonthsThatEarnAndTheTariffOfMeanPeaks) {
  const SizeContract contract{.name = "",
                              .costs = {},
                              .wear_eur_per_mwh = 7,
                              .cycles_per_day_max = 0,
                              .share_percent = 50,
                              .fee_eur_per_month = 10,
                              .capacity_eur_per_kw_year = 4,
                              .capacity_free_kw = 100};
  SizePlan plan;
  const SizeCell cell = size_cell(plan, contract, traded_by_hand(7), 1e6, 2e6);
  // Half of May's 6, all of June's -2, over four days of a battery twice as large; wear is no
  // money.
  EXPECT_NEAR(cell.margin_eur_per_year, (3 - 2) / 4.0 * 365.25 * 2, 1e-9);
  EXPECT_NEAR(cell.fixed_eur_per_year, 12 * 10 + 4 * (750 - 100), 1e-9);
  EXPECT_NEAR(cell.profit_eur_per_day_per_mwh, 1 - 7, 1e-9);
  EXPECT_NEAR(cell.eur_per_cycle(), cell.eur_per_year() / (0.5 * 365.25), 1e-9);
  EXPECT_NEAR(cell.error_eur_per_year, std::sqrt(2.0 * 2 * 2.5 * 2.5) / 4 * 365.25 * 2, 1e-9);
}

TEST(Size, ABatteryPaysBackWhileItAges) {
  SizeCell cell{};
  cell.margin_eur_per_year = 1200;
  cell.fixed_eur_per_year = 600;
  cell.price_eur = 100;
  cell.cycles_per_day = 0;
  // 12 % a year, 1 % a month of what was bought: it ends at 97 % after three months of 50, 49, 48.
  add_lifetime(cell, {12, 0, 97.5});
  EXPECT_NEAR(cell.life_years, 3 / 12.0, 1e-9);
  EXPECT_NEAR(cell.life_eur, -100 + 50 + 49 + 48, 1e-9);
  EXPECT_NEAR(cell.pay_back_years, (2 + 1 / 48.0) / 12, 1e-9);
  cell.price_eur = 1000;
  add_lifetime(cell, {12, 0, 97.5});
  EXPECT_TRUE(std::isnan(cell.pay_back_years));
  // By full cycles alone: 1,000 of them in a month take 10 % of the rest.
  cell.cycles_per_day = 1000 * 12 / 365.25;
  add_lifetime(cell, {0, 10, 80});
  EXPECT_NEAR(cell.life_years, 3 / 12.0, 1e-9) << "90 %, 81 %, 72.9 %";
}

/// A quarter-hour ends inside a step: each has one of its minutes.
TEST(Size, PeaksAreOfQuarterHoursAndLocalMonths) {
  const std::int64_t may_utc_s = local_midnight_utc_s({2024, 5, 1});
  std::vector<StepRecord> steps;
  const auto add = [&](std::int64_t utc_s, double power_w) {
    steps.push_back({utc_s, 0, 0, 0, 0, Action::kIdle, power_w, 0});
  };
  for (int i = 0; i < 8; ++i) add(may_utc_s - 16 * 60 + 120 * i, i == 7 ? 900 : -500);
  add(may_utc_s + 14 * 60, 300);
  add(may_utc_s + 40 * 60, 150);
  const std::vector<MonthPeak> peaks = month_peaks(steps, 1000);
  ASSERT_EQ(peaks.size(), 2U);
  EXPECT_EQ(peaks[0].month, "2024-04");
  EXPECT_NEAR(peaks[0].power_share, 2 * 0.9 / 15, 1e-12);
  EXPECT_EQ(peaks[1].month, "2024-05");
  EXPECT_NEAR(peaks[1].power_share, 0.3 / 15, 1e-12) << "each of both has one minute of 300 W";
}

TEST(Size, TheBestPaysBackSoonest) {
  std::vector<SizeCell> cells(3);
  for (SizeCell& cell : cells) {
    cell.price_eur = 100;
    cell.pay_back_years = NAN;
  }
  cells[0].life_eur = -50;
  cells[1].life_eur = -10;
  cells[2].life_eur = -60;
  EXPECT_EQ(&best_of(cells), &cells[1]);
  cells[2].pay_back_years = 9;
  cells[0].pay_back_years = 4;
  EXPECT_EQ(&best_of(cells), &cells[0]);
}

TEST(Size, AWrongPlanIsReportedWithItsPlace) {
  const TemporaryFolder folder;
  const auto complaint = [&](const std::string& text) {
    return refusal_of([&] { (void)read_size_plan(folder.write("plan.toml", text), {}); });
  };
  const std::string good = "[size]\npower_kw = [5]\ncapacity_kwh = [10]\n";
  EXPECT_EQ(complaint(good), "");
  const std::pair<std::string, const char*> cases[] = {
      {"[size]\npower_kw = [5]\n", "capacity_kwh"},
      {"[size]\npower_kw = [5, 5]\ncapacity_kwh = [1]\n", "plan.toml:2 power_kw"},
      {"[size]\npower_kw = [0]\ncapacity_kwh = [1]\n", "plan.toml:2 power_kw 0.01"},
      {"[size]\npower_kw = []\ncapacity_kwh = [1]\n", "plan.toml:2 [size] power_kw"},
      {good + "[[contract]]\nshare_percent = 5\n", "name"},
      {good + "[[contract]]\nname = \"a\"\nshare = 5\n", "plan.toml:6"},
      {good + "[[contract]]\nname = \"a\"\n[[contract]]\nname = \"a\"\n",
       "plan.toml:6 [[contract]]"},
      {good + "[ageing]\nend_percent = 0\n", "end_percent"}};
  for (const auto& [text, names] : cases) EXPECT_THAT(complaint(text), Names(names)) << text;
}

}  // namespace
}  // namespace bess
