// What a sweep came to, from results made by hand: tables, folded seeds, sites and the page.
#include "workstation/sweep/collected.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "tests/support/temporary_folder.h"
#include "workstation/report/comparison.h"
#include "workstation/run/run_folder.h"
#include "workstation/run/run_summary.h"
#include "workstation/sweep/sweep_page.h"

namespace bess {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class Collected : public testing::Test {
 protected:
  /// Published: earned `eur` a day with 8 MWh, on two days.
  void publish(int task, double eur) {
    const std::filesystem::path result = folder_.result(task);
    Evaluation days;
    days.capacity_mwh = 8;
    days.days = {{"2023-01-26", eur, 1, 2, 0.5, 3}, {"2023-02-26", eur, 1, 2, 0.5, 3}};
    write_file(result / run_file::kTable,
               comparison_csv({{"rbc", days, days}, {kExportedPolicy, days, days}}));
    write_file(result / run_file::kRecord, R"({"figures":{"weights_hash":"0123abcd"}})");
    write_file(result / run_file::kTimes, R"({"teacher":{"seconds":2.5},"header":{"seconds":1}})");
    write_file(result / run_file::kStudent, "{}");
  }
  std::vector<CollectedTask> collected() {
    return collect_tasks(folder_, tasks_, task_states(folder_, static_cast<int>(tasks_.size())));
  }

  TemporaryFolder root_;
  SweepFolder folder_{root_.file("sweep")};
  std::vector<SweepTask> tasks_{{1, {{"seed", "1"}, {"distil.fidelity", "1"}}},
                                {2, {{"seed", "2"}, {"distil.fidelity", "1"}}},
                                {3, {{"seed", "1"}, {"distil.fidelity", "10"}}},
                                {4, {{"seed", "2"}, {"distil.fidelity", "10"}}}};
};

TEST_F(Collected, ARowATaskWithWhatBecameOfIt) {
  publish(1, 80);
  write_file(folder_.result(3) / run_file::kUnprovedStudent, "{}");
  write_file(folder_.result(3) / run_file::kRecord, "{}");
  EXPECT_EQ(mean_seconds(folder_, task_states(folder_, 2)), 3.5);
  EXPECT_EQ(mean_seconds(folder_, {TaskState::kMissing}), 0) << "nobody knows yet";
  const std::string csv = tasks_csv(collected());
  EXPECT_THAT(csv, HasSubstr("task,state,seed,distil.fidelity,days,"));
  EXPECT_THAT(csv, HasSubstr("\n1,proved,1,1,2,10.0000,"));
  EXPECT_THAT(csv, HasSubstr(",0123abcd,3.50\n"));
  EXPECT_THAT(csv, HasSubstr("\n2,missing,2,1,,"));
  EXPECT_THAT(csv, HasSubstr("\n3,not proved,1,10,,"));
}

TEST_F(Collected, SeedsAreFoldedWithTheirError) {
  publish(1, 80);
  publish(2, 96);
  publish(3, 40);
  const auto rows = fold_seeds(collected());
  ASSERT_EQ(rows.size(), 2);
  EXPECT_EQ(rows[0].tasks, 2);
  EXPECT_DOUBLE_EQ(rows[0].mean, 11);
  EXPECT_DOUBLE_EQ(*rows[0].standard_error, 1) << "sqrt(((10 - 11)^2 + (12 - 11)^2) / 1 / 2)";
  EXPECT_DOUBLE_EQ(rows[0].low, 10);
  EXPECT_DOUBLE_EQ(rows[0].high, 12);
  EXPECT_EQ(rows[1].proved, 1);
  EXPECT_FALSE(rows[1].standard_error.has_value());
  EXPECT_THAT(varying_settings(collected()), ElementsAre("seed", "distil.fidelity"));
}

TEST_F(Collected, OfMonthsTheErrorIsOverMonths) {
  tasks_ = {{1, {{"seed", "1"}, {"fold", "2023-07"}}},
            {2, {{"seed", "2"}, {"fold", "2023-07"}}},
            {3, {{"seed", "1"}, {"fold", "2023-08"}}},
            {4, {{"seed", "2"}, {"fold", "2023-08"}}}};
  publish(1, 80);
  publish(2, 96);  // July 11
  publish(3, 40);
  publish(4, 40);  // August 5
  const auto rows = fold_seeds(collected());
  ASSERT_EQ(rows.size(), 1);
  EXPECT_DOUBLE_EQ(rows[0].mean, 8);
  EXPECT_DOUBLE_EQ(*rows[0].standard_error, 3);
}

TEST_F(Collected, ASiteEarnsByItsCapacityWhatItsClassDoes) {
  for (SweepTask& task : tasks_) task.settings.emplace_back(setting::kClass, "c");
  publish(1, 80);
  publish(2, 96);
  write_file(folder_.base(), "");
  const auto sites = collect_sites(folder_, collected(),
                                   {{"a", "north", 4e3, 8e3, 0.5, "c"}, {"b", "", 1, 1, 0.5, "d"}});
  EXPECT_DOUBLE_EQ(*sites[0].profit, 11);
  EXPECT_DOUBLE_EQ(*sites[0].eur_per_day, 0.088);
  EXPECT_EQ(sites[0].header, "tasks/000/000001/student_weights.h");
  EXPECT_FALSE(sites[1].profit.has_value());
  EXPECT_THAT(sites_csv(sites), AllOf(HasSubstr("\na,north,c,4000,8000,4,2,11.0000,0.0880,tasks/"),
                                      HasSubstr("\nb,,d,1,1,0,0,,,,,\n")));
}

TEST_F(Collected, OfARoundedRateASiteEarnsWhatTheStudentDoesAtItsOwn) {
  const std::string tests = std::string(BESS_SOURCE_DIR) + "/tests/";
  write_file(folder_.base(), "");
  write_file(folder_.prices(), read_file(tests + "data/benchmark_minutes_2023.csv.gz"));
  tasks_[0].settings.emplace_back(setting::kClass, "c");
  const std::string student = read_file(tests + "fuzz/seeds/student_file_fuzz/proved.json");
  const auto of_rate = [&](double rate_per_h) {
    return collect_sites(folder_, collected(), {{"a", "", 8e6 * rate_per_h, 8e6, 0.5, "c"}})[0];
  };
  publish(1, 80);
  write_file(folder_.result(1) / run_file::kStudent, student);
  const double at_same = *of_rate(0.5 + 1e-7).profit_at_own_rate;
  publish(1, 8 * at_same);  // what evaluation had found
  write_file(folder_.result(1) / run_file::kStudent, student);
  EXPECT_FALSE(of_rate(0.5).profit_at_own_rate.has_value());

  const CollectedSite stronger = of_rate(0.505), weaker = of_rate(0.495);
  EXPECT_LT(*weaker.profit_at_own_rate, at_same);
  EXPECT_GT(*stronger.profit_at_own_rate, at_same);
  EXPECT_DOUBLE_EQ(*stronger.eur_per_day, *stronger.profit_at_own_rate * 8);
  for (const CollectedSite& site : {stronger, weaker}) {
    EXPECT_GT(*site.rounding_loss_at_most, 0);
    EXPECT_LT(*site.rounding_loss_at_most, 0.01 * at_same) << "a hundredth less power";
  }
  EXPECT_GT(*of_rate(0.3).rounding_loss_at_most, 0.1 * at_same) << "a rate that is far away";
  EXPECT_THAT(sites_csv({weaker}),
              HasSubstr(fmt::format(",{:.4f},{:.4f}\n", *weaker.profit_at_own_rate,
                                    *weaker.rounding_loss_at_most)));
}

TEST_F(Collected, ThePageHasMapDotsAndTables) {
  for (int task = 1; task <= 3; ++task) publish(task, 80 - 10 * task);
  const SweepRecord record{"id", "bess-train", "crc32 1", "market <1>.csv", "lean", 0};
  const std::string page = sweep_page(record, collected(), {}, {});
  EXPECT_THAT(page, AllOf(HasSubstr("<table id=\"map\">"), HasSubstr("distil.fidelity across"),
                          HasSubstr("<table class=\"sortable\" id=\"tasks\">"),
                          HasSubstr("\"kind\":\"dots\""), HasSubstr("market &lt;1&gt;.csv"),
                          HasSubstr("1 without a result"), Not(HasSubstr("id=\"sites\""))));
  EXPECT_LT(page.find(">1</th>"), page.find(">10</th>")) << "numbers are sorted as numbers";
  EXPECT_THROW(sweep_page(record, collected(), {}, {"train.steps"}), UserError);
}

}  // namespace
}  // namespace bess
