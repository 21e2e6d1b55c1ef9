// Finished runs as figures: the table of runs, its days, and the facts of a run.
#include "workstation/runs/run/run_report.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <stdlib.h>

#include <algorithm>

#include "shared/host/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "tests/unit/workstation/report/report_test_support.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/report/evaluation_days.h"
#include "workstation/report/headline.h"

namespace bess {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Three days, the first of which earned `profit_eur`; thirds do not end in binary.
Evaluation evaluation_of(double profit_eur) {
  Evaluation evaluation;
  evaluation.capacity_mwh = BatteryParameters{}.capacity_wh / 1e6;
  evaluation.days = {{"2023-01-26", profit_eur, 1 / 3.0, 4, 0.5, 2 / 3.0},
                     {"2023-01-27", -1 / 3.0, 0, 0, 0.1, 0},
                     {"2023-01-28", 7, 2, 9, 1, 3}};
  return evaluation;
}

std::vector<NamedEvaluation> evaluations_of(double profit_eur) {
  return {{"rbc", evaluation_of(1), evaluation_of(2)},
          {kCorrectedName, evaluation_of(profit_eur), evaluation_of(2 * profit_eur)}};
}

RunSummary run_of(const char* seed, double profit_eur) {
  RunSummary run{{std::string("runs/seed-") + seed}, {}, evaluations_of(profit_eur)};
  run.record.identity = {{"prices", "0badcafe"}, {"seed", seed}};
  run.record.figures = RunFigures{"made by hand", "0123abcd", 1, 2, 0};
  return run;
}

TEST(EvaluationDays, ReadBackToTheBit) {
  const auto written = evaluations_of(10 / 3.0);
  const std::string text = evaluation_days_csv(written);
  const auto read = parse_evaluation_days_csv(text, "days.csv", {});
  EXPECT_EQ(evaluation_days_csv(read), text);
  EXPECT_EQ(comparison_csv(read), comparison_csv(written));
  EXPECT_THROW((void)parse_evaluation_days_csv(text + "rbc,2023-01-29,0,0,0,0,half,0,0,0,\n",
                                               "days.csv", {}),
               UserError);
}

/// The same figure, carried over, in page, summary, JSON and table of runs, to the digit.
TEST(RunSummaries, TheSameFigureIsEverywhere) {
  RunSummary run = run_of("1", 24.7);
  run.record.figures->last_learnt_day = "2023-01-25";
  for (NamedEvaluation& named : run.evaluations) value_charge_left(named.carried_over, {}, 87.3);
  // As a finished run is read back from its folder.
  run.evaluations = parse_evaluation_days_csv(evaluation_days_csv(run.evaluations), "days", {});
  const std::string figure =
      fmt::format("{:.1f}", run.evaluations[1].carried_over.profit_eur_per_day_per_mwh());
  const std::string friendlier =
      fmt::format("{:.1f}", run.evaluations[1].day_reset.profit_eur_per_day_per_mwh());
  ASSERT_NE(figure, friendlier);
  const Headline headline = headline_of(run.evaluations).value();
  EXPECT_THAT(headline_html(headline),
              AllOf(HasSubstr("\"headline-profit\">" + figure + "<"), Names(friendlier)));
  EXPECT_THAT(headline_text(headline), Names(figure + " EUR " + friendlier));
  const Json json = Json::parse(summary_json(run).line());
  const JsonValue told = json.value()["headline"];
  EXPECT_EQ(fmt::format("{:.1f}", told["profit_eur_per_day_per_mwh"].number().value()), figure);
  EXPECT_EQ(
      fmt::format("{:.1f}", told["profit_from_same_soc_eur_per_day_per_mwh"].number().value()),
      friendlier);
  EXPECT_EQ(told["carry_soc"].boolean(), true);
  EXPECT_EQ(told["charge_price_eur_per_mwh"].number(), 87.3);
  for (const JsonValue row : json.value()["policies"]) {
    if (row["policy"].text_or("") != std::string_view(kCorrectedName)) continue;
    const bool is_carried = row["carry_soc"].boolean() == true;
    EXPECT_EQ(fmt::format("{:.1f}", row["profit_eur_per_day_per_mwh"].number().value()),
              is_carried ? figure : friendlier);
  }
  EXPECT_THAT(format_runs_table({run}),
              Names(figure + " " + friendlier +
                    " 26 3 1 2023-01-26 2023-01-28 2023-01-25 bess-train backtest --seed 1"));
  EXPECT_THAT(format_comparison_table(run.evaluations), Names(figure + " 87.30 EUR/MWh"));
}

TEST(RunSummaries, TheTableSaysWhatRunsEarnedAndDifferIn) {
  const std::string table = format_runs_table({run_of("1", 24), run_of("2", 48)});
  EXPECT_THAT(table,
              AllOf(Names("runs/seed-2 +2.0 seed"), HasSubstr("1 | 2"), Not(Names("0badcafe"))));
}

/// Rules are described, not printed as the file's text; a key that only a later run has is a
/// difference too.
TEST(RunSummaries, RulesOfEitherRunAreADifference) {
  const char* const rules = "[[rule]]\nname = \"rest\"\nhours = \"23:00-06:00\"\nis = \"idle\"\n";
  for (const bool first_has_them : {true, false}) {
    std::vector<RunSummary> runs{run_of("1", 24), run_of("2", 48)};
    Entries& identity = runs[first_has_them ? 0 : 1].record.identity;
    identity.emplace_back(kRulesKey, rules);
    identity.emplace_back("[new] key", "7");
    const std::string table = format_runs_table(runs);
    EXPECT_THAT(table, Names("rules \"rest\" 23:00-06:00 [new] key 7"));
    const std::size_t bar = table.find(" | ", table.find("[new] key"));
    EXPECT_EQ(table[bar - 1] == '7', first_has_them) << table;
    EXPECT_THAT(table, Not(HasSubstr("[[rule]]")));
  }
}

/// Each rule's cost is a part of a price, no competitor; violations are listed by demand.
TEST(RunSummaries, ARunWithRulesShowsTheCostAndViolationsOfEach) {
  RunSummary run = run_of("1", 24);
  run.evaluations.insert(run.evaluations.begin() + 1,
                         {{kPlainName, evaluation_of(48), evaluation_of(48)},
                          {under_rule_name("rest"), evaluation_of(40), evaluation_of(40)},
                          {kUnderAllRules, evaluation_of(40), evaluation_of(40)}});
  run.record.figures->demands = {{"property 3", 7, 0}, {"rule \"rest\"", 68'924'057, 0}};
  const std::string json = summary_json(run).line();
  EXPECT_THAT(json, AllOf(HasSubstr("{\"demand\":\"property 3\",\"violations_plain\":7,"),
                          HasSubstr("\"violations_plain\":68924057,\"violations_corrected\":0}"),
                          HasSubstr("{\"part\":\"rule\",\"rule\":\"rest\","),
                          HasSubstr("{\"part\":\"correction\",")));
  EXPECT_THAT(format_comparison_table(run.evaluations), Not(HasSubstr("under")));
  const RulePrices prices = rule_prices_of(run.evaluations).value();
  ASSERT_EQ(prices.rules.size(), 1U);
  EXPECT_EQ(prices.rules[0].meaning, "rest");
  // One of three days differs, by EUR per day over 8 MWh.
  EXPECT_NEAR(prices.rules[0].difference[0].mean, -8 / 3.0 / 8, 1e-12);
  EXPECT_NEAR(prices.correction.difference[0].mean, 8 / 3.0 / 8, 1e-12);
  EXPECT_NEAR(prices.total.difference[0].mean, 0, 1e-12);
}

TEST(RunSummaries, AnEditedEvaluationIsRejected) {
  const TemporaryFolder folder;
  const RunFolder run{folder.file("run")};
  const std::string days = evaluation_days_csv(evaluations_of(24));
  write_file(run.file(run_file::kDays), days);
  RunRecord record = run_of("1", 24).record;
  record.stages = {
      {"evaluation", {}, {{run_file::kDays, file_mark(run.file(run_file::kDays))}}, false}};
  save_run_record(run, record);
  EXPECT_EQ(load_run_summary(run).evaluations.size(), 2U);
  for (const std::string& other :
       {days + "rbc,2023-01-29,1e9,0,0,0,false,0,0,0,\n", std::string()}) {
    write_file(run.file(run_file::kDays), other);
    EXPECT_THAT(refusal_of([&] { load_run_summary(run); }),
                Names("evaluation_days.csv bess-train report --run"));
  }
}

TEST(RunSummaries, AnUnfinishedRunIsNamedWithTheRemedy) {
  const TemporaryFolder folder;
  const RunFolder run{folder.file("run")};
  const auto refusal = [&] { return refusal_of([&] { load_run_summary(run); }); };
  EXPECT_THAT(refusal(), Names(run.path.string()));
  RunRecord record;
  record.stages = {{"teacher", {}, {}, false}};
  save_run_record(run, record);
  EXPECT_THAT(refusal(), Names("teacher run --resume --out"));
  record.stages.push_back({"corrected student", {}, {}, true});
  record.stages.push_back({"report of the failed proof", {}, {}, false});
  save_run_record(run, record);
  EXPECT_THAT(refusal(), AllOf(Names("report.html run --from-teacher"), Not(Names("--resume"))));
}

using testing::MatchesRegex;

class RunFacts : public testing::Test {
 protected:
  ~RunFacts() override { unsetenv("SOURCE_DATE_EPOCH"); }

  Entries facts() { return run_facts(RunConfig{}, small_market(), RunFolder{folder_.file("")}); }

  void put(const std::string& name, const std::string& text) const {
    (void)folder_.write(name, text);
  }

  TemporaryFolder folder_;
};

TEST_F(RunFacts, PricesAreNamedWithTheirChecksum) {
  const auto prices = folder_.write("market.csv", "123456789");  // the check value of CRC-32
  put("run.json", "{\"prices\": \"" + prices + "\"}");
  EXPECT_THAT(value_in(facts(), "prices"), Names("market.csv crc32 cbf43926 9"));
}

TEST_F(RunFacts, SayWhenWhereAndHow) {
  put("run.json", "{}");
  put("times.json", R"({"teacher": {"seconds": 12.25, "finished_utc": "x"}})");
  const Entries all = facts();
  EXPECT_THAT(value_in(all, "date"), MatchesRegex("20..-..-..T..:..:..Z"));
  EXPECT_THAT(value_in(all, "command"), Names("report_test"));
  EXPECT_EQ(value_in(all, "run"),
            std::filesystem::path(folder_.file("x")).parent_path().filename().string());
  EXPECT_THAT(value_in(all, "program"), MatchesRegex("bess-train .*, commit .*"));
  EXPECT_THAT(value_in(all, "span"), Names("2023-01-01 2023-02-28 40"));
  EXPECT_THAT(value_in(all, "observation delay"), Names("1"));
  EXPECT_EQ(value_in(all, "stages"), "teacher 12.2 s");
  EXPECT_NE(value_in(all, "host"), "");
}

TEST_F(RunFacts, AFixedDateLeavesOutWhatDiffers) {
  put("run.json", "{}");
  put("times.json", R"({"teacher": {"seconds": 12.2, "finished_utc": "x"}})");
  setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
  const Entries all = facts();
  EXPECT_EQ(value_in(all, "date"), "2023-11-14T22:13:20Z");
  for (const char* name : {"run", "host", "command", "CPU time", "stages"}) {
    EXPECT_EQ(value_in(all, name), "") << name;
  }
}

}  // namespace
}  // namespace bess
