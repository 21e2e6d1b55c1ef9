// Many runs on one page: finished ones with figures, and the state of the others.
#include <gmock/gmock.h>

#include <filesystem>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "workstation/report/evaluation_days.h"
#include "workstation/runs/run/run_report.h"

namespace bess {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

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

}  // namespace
}  // namespace bess
