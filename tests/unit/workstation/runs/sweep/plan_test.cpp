// Points, sites and plans: tasks, their numbers, and refusals before the first.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "shared/host/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "workstation/runs/chain/run_config.h"
#include "workstation/runs/sweep/sweep_plan.h"

namespace bess {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::SizeIs;
using testing::StartsWith;

namespace fs = std::filesystem;

constexpr const char* kTwo = "[grid]\n\"distil.fidelity\" = [1, 2]\n";

class SweepPlans : public testing::Test {
 protected:
  SweepPlans() {
    request_.prices = std::string(BESS_SOURCE_DIR) + "/tests/data/benchmark_minutes_2023.csv.gz";
  }
  SweepPlan plan(const std::string& text) {
    request_.plan = root_.write("plan.toml", text);
    return plan_sweep(request_, folder_);
  }
  std::string refusal(const std::string& text) {
    return refusal_of([&] { plan(text); });
  }
  std::vector<std::string> settings(const SweepPlan& of) {
    std::vector<std::string> all;
    for (const SweepTask& task : of.tasks) all.push_back(settings_shown(task.settings));
    return all;
  }

  TemporaryFolder root_;
  SweepFolder folder_{root_.file("sweep")};
  SweepRequest request_;
};

TEST_F(SweepPlans, EveryCombinationOfTheGridForEverySeed) {
  request_.seeds = 2;
  EXPECT_THAT(settings(plan("[[list]]\n\"distil.epochs\" = 60\n[[list]]\n\"distil.epochs\" = 70\n"
                            "[grid]\n\"distil.fidelity\" = [1, 2.5]\n")),
              testing::ElementsAre("seed 1, distil.epochs 60, distil.fidelity 1",
                                   "seed 1, distil.epochs 60, distil.fidelity 2.5",
                                   "seed 1, distil.epochs 70, distil.fidelity 1",
                                   "seed 1, distil.epochs 70, distil.fidelity 2.5",
                                   "seed 2, distil.epochs 60, distil.fidelity 1",
                                   "seed 2, distil.epochs 60, distil.fidelity 2.5",
                                   "seed 2, distil.epochs 70, distil.fidelity 1",
                                   "seed 2, distil.epochs 70, distil.fidelity 2.5"));
}

TEST_F(SweepPlans, ASetOfTheCommandLineIsAnAxisOfTheGrid) {
  request_.sets = {"distil.fidelity=1,2", "train.method=sdp"};
  request_.seeds = 3;
  const SweepPlan planned = plan("");
  EXPECT_THAT(planned.tasks, SizeIs(6));
  EXPECT_EQ(planned.tasks.front().value("train.method"), "\"sdp\"");
}

TEST_F(SweepPlans, EachMonthThatCanBeTradedIsATask) {
  request_.folds = "monthly";
  const SweepPlan planned = plan("");
  ASSERT_GE(planned.tasks.size(), 2);
  EXPECT_EQ(planned.tasks.front().value("fold").substr(0, 5), "2023-");
}

TEST_F(SweepPlans, WhatCannotBeIsRefusedWithItsPlace) {
  const std::pair<const char*, const char*> cases[] = {
      {"[grid]\n\"distil.fidelity\" = [1,\n 1000]\n", "plan.toml:3 [distil] fidelity 1000"},
      {"[grid]\n\"distil.fidelty\" = 1\n", "plan.toml:2 [distil] fidelty fidelity"},
      {"[grid]\nfidelity = [1, 2]\n", "plan.toml:2 \"fidelity\""},
      {"[gird]\n", "plan.toml:1 gird grid list"},
      {"[grid]\n\"distil.fidelity\" = []\n", "plan.toml:2 distil.fidelity"},
      {"[grid]\n\"distil.fidelity\" = [1, 1.0]\n", "plan.toml:2 distil.fidelity"},
      {"[grid]\n\"distil.fidelity\" = 1\n[[list]]\n\"distil.fidelity\" = 2\n", "distil.fidelity"},
      // What keys are to each other is looked at before task 1 begins.
      {"[grid]\n\"battery.soc_min\" = [0.1, 0.6]\n", "2 initial_soc 0.5 soc_min 0.6"},
      // A sweep takes no day-ahead prices.
      {"[grid]\n\"train.context\" = [\"level\", \"outlook\"]\n", "2 [train] context"}};
  for (const auto& [text, names] : cases) EXPECT_THAT(refusal(text), Names(names)) << text;
  EXPECT_FALSE(fs::exists(folder_.path));
}

TEST_F(SweepPlans, PlannedAgainWithMoreEveryTaskKeepsItsNumber) {
  write_plan(plan(kTwo), request_);
  const std::string before = read_file(folder_.tasks());
  request_.seeds = 2;
  const SweepPlan more = plan("[grid]\n\"distil.fidelity\" = [0.5, 1, 2]\n");
  EXPECT_EQ(more.known, 2);
  write_plan(more, request_);
  EXPECT_THAT(load_tasks(folder_), SizeIs(6));
  EXPECT_TRUE(read_file(folder_.tasks()).starts_with(before));
  EXPECT_EQ(plan("[grid]\n\"distil.fidelity\" = [0.5, 1, 2]\n").known, 6);
}

TEST_F(SweepPlans, AnotherPlanPricesOrConfigurationIsRefusedNamingBoth) {
  write_plan(plan(kTwo), request_);
  EXPECT_THAT(refusal("[grid]\n\"distil.fidelity\" = [1, 3]\n"), Names("2 1 distil.fidelity"));
  request_.full = true;
  EXPECT_THAT(refusal(kTwo), Names("kind lean full"));
  request_.full = false;
  const std::string own = request_.prices;
  request_.prices = root_.write("other name.csv", read_file(own));
  EXPECT_EQ(plan(kTwo).known, 2) << "prices count by content";
  request_.config = root_.write("other.toml", "[train]\nsteps = 7\n");
  EXPECT_THAT(refusal(kTwo), Names("[train] steps 7"));
  request_.config.clear();
  const std::string minutes = read_file(request_.prices);
  request_.prices =
      root_.write("fewer.csv", minutes.substr(0, minutes.rfind('\n', minutes.size() * 9 / 10) + 1));
  EXPECT_THAT(refusal(kTwo), Names("prices crc32"));
}

TEST_F(SweepPlans, AnotherProgramIsRefusedNamingBoth) {
  write_plan(plan(""), request_);
  std::string record = read_file(folder_.record());
  record.replace(record.find("commit "), 11, "commit older");
  write_file(folder_.record(), record);
  EXPECT_THAT(refusal_of([&] { load_own_sweep(folder_); }), HasSubstr("commit older"));
}

TEST_F(SweepPlans, ATaskHasItsOwnConfigurationAndOneThread) {
  request_.sets = {"distil.fidelity=1,2"};
  const SweepPlan planned = plan("");
  write_plan(planned, request_);
  const RunConfig config = config_of_task(folder_, planned.base, planned.tasks[1]);
  EXPECT_EQ(config.distil.fidelity, 2);
  EXPECT_EQ(config.train.threads, 1);
  EXPECT_EQ(config.train.seed, 1);
}

TEST_F(SweepPlans, SitesThatLearnAlikeShareAStudent) {
  (void)root_.write("big.toml", "[battery]\npower_w = 4e6\ncapacity_wh = 8e6\n");
  (void)root_.write("small.toml", "[battery]\npower_w = 4000\ncapacity_wh = 8000\n");
  (void)root_.write("fast.toml", "[battery]\npower_w = 8000\ncapacity_wh = 8000\n");
  (void)root_.write("odd.toml", "[battery]\npower_w = 3300\ncapacity_wh = 10000\n");
  (void)root_.write("odd2.toml", "[battery]\npower_w = 3.3e6\ncapacity_wh = 1e7\n");
  (void)root_.write("dear.toml", "[costs]\nimport_percent = 5\n");
  (void)root_.write("rule.toml",
                    "[[rule]]\nname = \"calm\"\nprice_min = 301\nat_most = \"idle\"\n");
  request_.sites =
      root_.write("sites.csv",
                  "id,battery,contract,rules,correction.high_price_eur_per_mwh,region\n"
                  "a,big.toml,,,,north\nb,small.toml,,,,south\nc,fast.toml,,,,\n"
                  "d,small.toml,dear.toml,,,\ne,small.toml,,rule.toml,,\n"
                  "f,big.toml,,,250,\ng,odd.toml,,,,\nh,odd2.toml,,,,\n");
  const SweepPlan planned = plan("");
  EXPECT_EQ(planned.classes, 6);
  EXPECT_THAT(planned.tasks, SizeIs(6));
  const auto student = [&](std::size_t site) { return planned.sites.at(site).student; };
  EXPECT_EQ(student(0), student(1)) << "4 MW / 8 MWh and 4 kW / 8 kWh";
  EXPECT_EQ(student(6), student(7)) << "a rate of no binary fraction";
  EXPECT_NE(student(1), student(2));
  write_plan(planned, request_);
  EXPECT_EQ(load_sites(folder_).at(1).region, "south");
  const auto of_rule = std::ranges::find_if(
      planned.tasks, [](const SweepTask& task) { return !task.value("rules").empty(); });
  EXPECT_THAT(config_of_task(folder_, planned.base, *of_rule).distil.rules.rules, SizeIs(1));
}

TEST_F(SweepPlans, RoundedRatesShareAStudentOnlyWhereThePlanSaysSo) {
  request_.sites = root_.write("sites.csv",
                               "id,battery.power_w,battery.capacity_wh\na,5000,13500\n"
                               "b,5000,13400\nc,5000,13100\nd,4000,8000\n");
  EXPECT_EQ(plan("").classes, 4);
  request_.c_rate_step_percent = 2;
  const SweepPlan rounded = plan("");
  EXPECT_EQ(rounded.classes, 3);
  EXPECT_EQ(rounded.sites[0].student, rounded.sites[1].student);
  EXPECT_EQ(rounded.sites[0].power_w, 5000) << "the site's own";
  for (double rate = 0.1; rate < 3; rate *= 1.0013) {
    RunConfig config;
    config.battery.power_w_max = rate * config.battery.capacity_wh;
    const double ratio = canonical(config, 2).battery.power_w_max / config.battery.power_w_max;
    EXPECT_NEAR(std::log(ratio), 0, std::log(1.02) / 2 + 1e-9);
  }
}

TEST_F(SweepPlans, AMistakeOfASiteIsReportedWithItsLine) {
  const auto with = [&](const std::string& csv) {
    request_.sites = root_.write("sites.csv", csv);
    return refusal("");
  };
  EXPECT_THAT(with("id,battery.power_w\na,5\n"), Names("sites.csv:2 power_w 5 100"));
  EXPECT_THAT(with("id,region\na,x\na,y\n"), Names("sites.csv:3 \"a\""));
  EXPECT_THAT(with("id,batery\na,x\n"), Names("sites.csv \"batery\" id"));
  EXPECT_THAT(with("id,battery\na,none.toml\n"), HasSubstr("none.toml"));
}

TEST(ConfigKeys, LearningKeysMakeAClass) {
  const RunConfig base;
  const std::string key = learning_key(base, "");
  for (const auto& [name, value] : config_entries(base)) {
    const bool is_of_evaluation = name == "[market] day_ahead_published_min" ||
                                  name == "[battery] fade_percent_per_1000_cycles" ||
                                  name == "[battery] minimum_run_min";
    const bool is_in_it = key.find(name + " = " + value + "\n") != key.npos;
    EXPECT_NE(is_in_it, is_of_evaluation) << name;
  }
  RunConfig other = base;
  other.market.day_ahead_published_min += 60;
  EXPECT_EQ(learning_key(other, ""), key) << "no learning stage reads day-ahead prices";
  other.battery.wear_eur_per_mwh += 1;
  EXPECT_NE(learning_key(other, ""), key);
  EXPECT_NE(learning_key(base, "[[rule]]"), key);
}

// The commands by which engines run a sweep.

TEST(Engines, ParallelRunsEachLineOfTheTasksUnlessItsJoblogHasIt) {
  const SweepFolder folder{"/a sweep"};
  EXPECT_THAT(
      shell_line(parallel_command(folder, 4)),
      AllOf(StartsWith("parallel --joblog '/a sweep/joblog' --resume-failed --colsep '\\t' "),
            HasSubstr("--jobs 4"), EndsWith(" :::: '/a sweep/tasks.tsv'")));
  const auto words = parallel_command(folder);
  EXPECT_THAT(words.at(words.size() - 3), EndsWith(" sweep task '/a sweep' {1}"))
      << "parallel's own shell parses it again";
}

TEST(Engines, AnArrayIsAThousandTasks) {
  const SweepFolder folder{"/sweep"};
  EXPECT_EQ(sbatch_lines(folder, {1, 2, 3, 7, 9, 10}),
            "sbatch --array=1-3,7,9-10 /sweep/array.sbatch\n");
  std::vector<int> tasks(2'001);
  std::iota(tasks.begin(), tasks.end(), 1);
  EXPECT_EQ(sbatch_lines(folder, tasks),
            "sbatch --array=1-1000 /sweep/array.sbatch\n"
            "sbatch --array=1-1000 /sweep/array.sbatch 1000\n"
            "sbatch --array=1 /sweep/array.sbatch 2000\n");
  EXPECT_EQ(sbatch_lines(folder, {}), "");
  EXPECT_THAT(
      array_script(folder),
      AllOf(StartsWith("#!/bin/sh\n"), HasSubstr("#SBATCH --output=\"/sweep/log/slurm.txt\""),
            HasSubstr(" sweep task /sweep $((SLURM_ARRAY_TASK_ID + ${1:-0}))\n")));
}

}  // namespace
}  // namespace bess
