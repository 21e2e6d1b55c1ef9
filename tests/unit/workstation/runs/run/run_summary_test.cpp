// Finished runs as figures: the table of runs, its days, and the facts of a run.
#include "workstation/runs/run/run_report.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "tests/support/integer_nets.h"
#include "tests/support/small_market.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "tests/unit/workstation/report/report_test_support.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/report/comparison.h"
#include "workstation/report/headline.h"
#include "workstation/runs/run/refresh.h"
#include "workstation/runs/run/run_backtest.h"

namespace bess {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::MatchesRegex;
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

// Walk-forward figure of a run: of its own prices, seed and keys, or none, with the reason.

RunRecord record_of(const RunConfig& config) {
  RunRecord record;
  record.identity = identity_of(config, "crc32 0badcafe, 7 minutes from 2023-01-01T00:00:00Z", "");
  return record;
}

void write_backtest(const RunFolder& folder, const std::string& learnt_from, const char* policy) {
  Json json = Json::object({{"learnt_from", learnt_from}});
  Json policies = Json::list();
  policies.add(Json::object({{"policy", "rbc"}, {"profit_eur_per_day_per_mwh", 1}}));
  policies.add(Json::object({{"policy", policy},
                             {"days", 90},
                             {"months", 3},
                             {"profit_eur_per_day_per_mwh", 412.3456},
                             {"profit_standard_error", 20.25},
                             {"profit_standard_error_by_month", 31.5}}));
  json.set("policies", std::move(policies));
  write_file(folder.path / kRunsBacktest / kBacktestJson, json.text());
}

class RunBacktest : public testing::Test {
 protected:
  static RunConfig seeded(std::uint64_t seed) {
    RunConfig config;
    config.set_seed(seed);
    return config;
  }
  const TemporaryFolder temporary_;
  const RunFolder folder_{temporary_.file("run")};
  const RunConfig config_ = seeded(7);
  const RunRecord record_ = record_of(config_);
};

TEST_F(RunBacktest, IsTakenWhenItIsOfTheSamePricesSeedAndKeys) {
  EXPECT_THAT(walk_forward_text(walk_forward_of(folder_, record_)),
              Names("bess-train backtest --seed 7 --out RUN/backtest"));
  EXPECT_EQ(with_run_folder("--out RUN/backtest RUN/a", "x/run"), "--out x/run/backtest x/run/a");
  const std::string identity = learning_identity(record_.value("prices"), config_);
  write_backtest(folder_, identity, kChainName);
  const WalkForwardOfRun walk = walk_forward_of(folder_, record_);
  ASSERT_TRUE(walk.figure.has_value()) << walk.why_none;
  EXPECT_THAT(walk_forward_text(walk), Names("412.3 20.2 31.5 90 3"));
  EXPECT_THAT(walk_forward_html(walk), HasSubstr("<a href=\"backtest/backtest.html\">"));
  EXPECT_THAT(walk_forward_json(*walk.figure).line(),
              HasSubstr("\"profit_eur_per_day_per_mwh\":412.3456"));
}

TEST_F(RunBacktest, OfAnythingElseIsNotTaken) {
  RunConfig other = config_;
  other.battery.wear_eur_per_mwh = 25;
  for (const std::string& identity :
       {learning_identity(record_.value("prices"), other),
        learning_identity(record_.value("prices"), seeded(8)),
        learning_identity("crc32 00000000, 7 minutes from 2023-01-01T00:00:00Z", config_)}) {
    write_backtest(folder_, identity, kChainName);
    const WalkForwardOfRun walk = walk_forward_of(folder_, record_);
    EXPECT_FALSE(walk.figure.has_value());
    EXPECT_THAT(walk.why_none, Names("backtest/backtest.json bess-train backtest --seed 7"));
  }
  write_backtest(folder_, learning_identity(record_.value("prices"), config_), "sdp");
  EXPECT_THAT(walk_forward_of(folder_, record_).why_none, Names("backtest/backtest.json student"));
  write_file(folder_.path / kRunsBacktest / kBacktestJson, "{ half of a");
  EXPECT_FALSE(walk_forward_of(folder_, record_).figure.has_value());
}

// Many runs on one page: finished ones with figures, and the state of the others.

class RunsPage : public testing::Test {
 protected:
  /// A run that earned `eur` on the second of two days of two months.
  RunFolder make(const std::string& name, double eur, const std::string& method = "\"sdp\"") {
    const RunFolder folder{root_.file(name)};
    std::filesystem::create_directories(folder.path);
    Evaluation days;
    days.capacity_mwh = 8;
    days.days = {{"2023-01-26", 8, 1, 2, 0.5, 3}, {"2023-02-26", eur, 1, 2, 0.5, 3}};
    write_file(folder.file(run_file::kDays), evaluation_days_csv({{kCorrectedName, days, days}}));
    write_file(folder.file(run_file::kReport), "<html></html>");
    RunRecord record;
    record.identity = {{"prices", "the same"}, {"seed", "1"}, {"[train] method", method}};
    record.stages = {
        {"evaluation", {}, {{run_file::kDays, file_mark(folder.file(run_file::kDays))}}, false}};
    record.figures = RunFigures{"made by hand", "0123abcd", 6'950'033'280, 1, 2, 0};
    save_run_record(folder, record);
    return folder;
  }

  RunFolder make_failed(const std::string& name) {
    const RunFolder folder = make(name, 8);
    RunRecord record = load_run_record(folder).value();
    record.figures.reset();
    record.stages.push_back({"corrected student", {}, {}, true});
    save_run_record(folder, record);
    write_file(folder.file(run_file::kProofRounds),
               "round,looked_at,demand,violations\n1,lattice,property 1,3\n"
               "1,lattice,property 3,23994\n");
    return folder;
  }

  std::string page_of(const std::vector<RunFolder>& folders) {
    std::vector<RunSummary> runs;
    for (const RunFolder& folder : folders) runs.push_back(load_any_run(folder));
    return runs_page(runs, root_.file("all.html"));
  }

  TemporaryFolder root_;
};

TEST_F(RunsPage, FiguresGainsProofAndLinks) {
  const std::string page = page_of({make("a", 24), make("b", 16)});
  EXPECT_THAT(
      page, AllOf(HasSubstr("<a href=\"a/report.html\">"), HasSubstr("<a href=\"b/report.html\">"),
                  Names("6,950,033,280 0123abcd")));
  EXPECT_THAT(page, HasSubstr("data-sort=\"2\"><span>2.0 \u00b1 1.0")) << "(8 + 24) / 2 / 8";
  EXPECT_THAT(page, HasSubstr("data-sort=\"-0.5\"><span>\u22120.5 \u00b1 0.5"));
  EXPECT_THAT(page, HasSubstr("data-sort=\"16\"><span>16.0")) << "the whole battery";
}

TEST_F(RunsPage, WhatRunsDifferInIsAColumn) {
  const std::string page = page_of({make("a", 24), make("b", 16, "\"c51\"")});
  EXPECT_THAT(page, AllOf(HasSubstr("<button type=\"button\">[train] method</button>"),
                          HasSubstr("&quot;c51&quot;"), Not(HasSubstr("the same</span>"))));
}

TEST_F(RunsPage, AFailedRunIsALineWithWhatIsLeft) {
  const std::string page = page_of({make_failed("failed"), make("b", 16)});
  EXPECT_THAT(page, AllOf(HasSubstr("<a href=\"failed/report.html\">"), Names("3 23994"),
                          HasSubstr("1.5 \u00b1 0.5")));
}

TEST_F(RunsPage, AStoppedRunSaysWhere) {
  const RunFolder folder = make("stopped", 8);
  RunRecord record = load_run_record(folder).value();
  record.figures.reset();
  save_run_record(folder, record);
  EXPECT_THAT(page_of({folder}), Names("evaluation"));
}

TEST_F(RunsPage, EditedNumbersAreNotShown) {
  const RunFolder folder = make("edited", 24);
  const auto path = folder.file(run_file::kDays);
  std::string text = read_file(path);
  text.replace(text.find(",24,"), 4, ",99,");
  write_file(path, text);
  const std::string page = page_of({folder});
  EXPECT_THAT(page, AllOf(Names("evaluation_days.csv"), Not(HasSubstr("\u00b1 1.0"))));
}

TEST_F(RunsPage, AFolderWithoutARunIsAnError) {
  std::filesystem::create_directories(root_.file("empty"));
  EXPECT_THROW((void)load_any_run({root_.file("empty")}), UserError);
}

// Comparison of two students: their money, their different decisions, when one is worse.

/// Sells from `high` on, buys below `low`, EUR/MWh.
StudentFile trader(int low, int high) {
  const auto at = [](int eur) { return 8 * (eur - kLatticePriceMinEurPerMwh); };
  return {hand_made_net(NetInput::kPrice, -1, at(low), at(high)), {}, "", {}};
}

MarketSteps fold_of_a_month() {
  return market_of_fold(make_market_steps(small_series(75), {}),
                        "2023-02-15 to 2023-03-16, 30 days before");
}

TEST(FoldDays, AreInARecordAndReadBack) {
  const auto days = parse_fold_days("2023-02-15 to 2023-03-16, 30 days before");
  ASSERT_TRUE(days);
  EXPECT_EQ(days->name(), "2023-02-15 to 2023-03-16, 30 days before");
  EXPECT_EQ(days->window_days, 30);
  EXPECT_FALSE(parse_fold_days("2023-02"));
  const MarketSteps fold = fold_of_a_month();
  EXPECT_EQ(fold.days_of(Split::kTest).size(), 30U);
  EXPECT_EQ(fold.days.front().date(), "2023-01-16");
  EXPECT_EQ(fold.days.size(), 60U);
}

TEST(CandidateRun, CountsTheDecisionsThatDifferWhereTheRunsStudentIs) {
  const MarketSteps market = fold_of_a_month();
  const CandidateRun candidate = judge_refit(trader(50, 150), trader(50, 160), market, {});
  std::size_t between = 0;  // where one sells and the other rests, at any charge
  for (const MarketDay& day : market.days_of(Split::kTest)) {
    for (const MarketStep& step : market.of(day)) {
      const auto price = lattice_price_of(price_centi_of(step.observed_eur_per_mwh));
      between += price >= 150 && price < 160 ? 1 : 0;
    }
  }
  ASSERT_GT(between, 100U);
  EXPECT_EQ(candidate.differing.size(), between);
  EXPECT_EQ(candidate.decisions, 30U * 720U);
  EXPECT_THAT(candidate_text(candidate), Names(std::to_string(between) + " discharge idle"));
  for (const DifferingDecision& d : candidate.differing) {
    EXPECT_EQ(d.before, Action::kDischarge);
    EXPECT_EQ(d.now, Action::kIdle);
  }
  const std::string csv = differing_decisions_csv(candidate);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(csv, '\n')), 1 + between);
  EXPECT_THAT(csv, testing::HasSubstr(",discharge,idle\n"));
}

TEST(CandidateRun, IsWorseBeyondItsErrorAlone) {
  const MarketSteps market = fold_of_a_month();
  const CandidateRun same = judge_refit(trader(50, 150), trader(50, 150), market, {});
  EXPECT_EQ(same.gain.mean, 0);
  EXPECT_FALSE(same.is_worse());
  const StudentFile idle{constant_net(Action::kIdle), {}, "", {}};
  const CandidateRun lost = judge_refit(trader(50, 150), idle, market, {});
  EXPECT_LT(lost.gain.mean, -3 * lost.gain.errors.plain);
  EXPECT_TRUE(lost.is_worse());
  const CandidateRun won = judge_refit(idle, trader(50, 150), market, {});
  EXPECT_FALSE(won.is_worse());
  EXPECT_NEAR(won.gain.mean, -lost.gain.mean, 1e-9);
  EXPECT_NEAR(won.gain.mean, won.now.profit_eur_per_day_per_mwh(), 1e-9) << "idle earns nothing";
  CandidateRun near = same;
  near.gain = {-1.0, {1.1}};
  EXPECT_FALSE(near.is_worse());
  near.gain.errors.plain = 0.9;
  EXPECT_TRUE(near.is_worse());
}

}  // namespace
}  // namespace bess
