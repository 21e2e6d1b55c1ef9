// Sweep results, from hand-made tasks: tables of tasks, settings and sites.
#include "workstation/runs/sweep/collected.h"

#include <gmock/gmock.h>

#include "shared/host/file.h"
#include "tests/support/temporary_folder.h"
#include "workstation/report/comparison.h"
#include "workstation/runs/run/run_record.h"
#include "workstation/runs/run/run_report.h"

namespace bess {
namespace {

using testing::HasSubstr;

class Collected : public testing::Test {
 protected:
  /// Published: earned `eur` per day with 8 MWh, on two days.
  void publish(int task, double eur) {
    const std::filesystem::path result = folder_.result(task);
    Evaluation days;
    days.capacity_mwh = 8;
    days.days = {{"2023-01-26", eur, 1, 2, 0.5, 3}, {"2023-02-26", eur, 1, 2, 0.5, 3}};
    write_file(result / run_file::kTable,
               comparison_csv({{"rbc", days, days}, {kCorrectedName, days, days}}));
    write_file(result / run_file::kRecord, R"({"figures":{"weights_hash":"0123abcd"}})");
    write_file(result / run_file::kTimes, R"({"teacher":{"seconds":2.5},"header":{"seconds":1}})");
    write_file(result / run_file::kStudent, "{}");
  }
  std::vector<CollectedTask> collected() { return collect_tasks(folder_, tasks_); }

  TemporaryFolder root_;
  SweepFolder folder_{root_.file("sweep")};
  std::vector<SweepTask> tasks_{{1, {{"seed", "1"}, {"distil.fidelity", "1"}}},
                                {2, {{"seed", "2"}, {"distil.fidelity", "1"}}},
                                {3, {{"seed", "1"}, {"distil.fidelity", "10"}}},
                                {4, {{"seed", "2"}, {"distil.fidelity", "10"}}}};
};

TEST_F(Collected, OneRowPerTaskWithItsResult) {
  publish(1, 80);
  write_file(folder_.result(3) / run_file::kUnprovedStudent, "{}");
  write_file(folder_.result(3) / run_file::kRecord, "{}");
  write_file(folder_.log(4), "teacher: ...\nfailed: no space left\n");
  const std::string csv = tasks_csv(collected());
  EXPECT_THAT(csv, HasSubstr("task,state,seed,distil.fidelity,days,"));
  EXPECT_THAT(csv, HasSubstr("\n1,proved,1,1,2,10.0000,"));
  EXPECT_THAT(csv, HasSubstr(",0123abcd,3.50\n"));
  EXPECT_THAT(csv, HasSubstr("\n2,missing,2,1,,"));
  EXPECT_THAT(csv, HasSubstr("\n3,not proved,1,10,,"));
  EXPECT_THAT(csv, HasSubstr("\n4,failed,2,10,,"));
  EXPECT_EQ(collected()[3].said, "failed: no space left");
  write_file(folder_.log(4), "failed: no space left\nteacher: ...\n");
  EXPECT_EQ(collected()[3].state, TaskState::kMissing) << "it runs again, or was killed";
}

TEST_F(Collected, SeedsAreFoldedWithTheirError) {
  publish(1, 80);
  publish(2, 96);
  publish(3, 40);
  EXPECT_EQ(settings_csv(collected()),
            "distil.fidelity,tasks,proved,profit_eur_per_day_per_mwh,profit_standard_error,"
            "profit_lowest_eur_per_day_per_mwh,profit_highest_eur_per_day_per_mwh,cycles_per_day\n"
            "1,2,2,11.0000,1.0000,10.0000,12.0000,1.0000\n"
            "10,2,1,5.0000,,5.0000,5.0000,1.0000\n")
      << "sqrt(((10 - 11)^2 + (12 - 11)^2) / 1 / 2)";
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
  EXPECT_THAT(settings_csv(collected()), HasSubstr("\n4,4,8.0000,3.0000,5.0000,12.0000,"));
}

TEST_F(Collected, ASiteEarnsByItsCapacityWhatItsClassDoes) {
  for (SweepTask& task : tasks_) task.settings.emplace_back(setting::kClass, "c");
  publish(1, 80);
  publish(2, 96);
  const auto sites =
      collect_sites(folder_, collected(), {{"a", "north", 4e3, 8e3, "c"}, {"b", "", 1, 1, "d"}});
  EXPECT_DOUBLE_EQ(sites[0].profit(), 11);
  EXPECT_DOUBLE_EQ(sites[0].eur_per_day(), 0.088);
  EXPECT_EQ(sites[0].header, "tasks/000/000001/student_weights.h");
  EXPECT_THAT(sites_csv(sites),
              testing::AllOf(HasSubstr("\na,north,c,4000,8000,4,2,11.0000,0.0880,tasks/"),
                             HasSubstr("\nb,,d,1,1,0,0,,,\n")));
}

}  // namespace
}  // namespace bess
