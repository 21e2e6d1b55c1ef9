#include "tests/workstation/report/page/many_runs.h"

#include <algorithm>
#include <functional>
#include <string>

#include "shared/host/file.h"
#include "shared/units_and_limits.h"
#include "workstation/report/evaluation_days.h"
#include "workstation/rules/rule_file.h"
#include "workstation/run/run_record.h"
#include "workstation/run/run_summary.h"

namespace bess {
namespace {

constexpr const char* kFirstMonth = "2023-01";

struct RunByHand {
  std::string name;
  std::uint64_t seed;
  double share;  ///< of what the baseline earned
  std::string weights_hash;
  std::string toml = {};
  std::string rules = {};
  bool first_month_only = false;
};

void change_days(NamedEvaluation& named, const std::function<void(Evaluation&)>& change) {
  change(named.day_reset);
  change(named.carried_over);
}

/// The student is judged before the bound, the last of the baselines.
std::vector<NamedEvaluation> evaluations_of(const RunByHand& run,
                                            const std::vector<NamedEvaluation>& baselines) {
  std::vector<NamedEvaluation> all = baselines;
  NamedEvaluation student = all[all.size() - 2];
  student.name = kExportedPolicy;
  change_days(student, [&](Evaluation& evaluation) {
    for (DayResult& day : evaluation.days) day.profit_eur *= run.share;
  });
  all.insert(all.end() - 1, student);
  if (!run.first_month_only) return all;
  for (NamedEvaluation& named : all) {
    change_days(named, [](Evaluation& evaluation) {
      std::erase_if(evaluation.days,
                    [](const DayResult& day) { return !day.date.starts_with(kFirstMonth); });
    });
  }
  return all;
}

RunRecord record_of(const RunByHand& run, const RunFolder& folder) {
  RunConfig config = parse_run_config(run.toml, run.name);
  config.set_seed(run.seed);
  config.set_threads(2);
  if (!run.rules.empty()) config.distil.rules = parse_rules(run.rules, run.name);
  RunRecord record;
  record.prices = "prices.csv.gz";
  record.prices_name = "prices.csv.gz";
  record.identity = identity_of(config, "crc32 0123abcd, 4711 bytes", "");
  record.stages = {
      {"evaluation", {}, {{run_file::kDays, file_mark(folder.file(run_file::kDays))}}, false}};
  record.figures = RunFigures{"made by hand", run.weights_hash, kLatticeStateCount, 2, 1, 0};
  record.figures->last_learnt_day = "2023-02-25";
  return record;
}

RunFolder write_run(const std::filesystem::path& root, const RunByHand& run,
                    const std::vector<NamedEvaluation>& baselines) {
  const RunFolder folder{root / run.name};
  std::filesystem::create_directories(folder.path);
  write_file(folder.file(run_file::kDays), evaluation_days_csv(evaluations_of(run, baselines)));
  write_file(folder.file(run_file::kReport), "<html></html>");
  save_run_record(folder, record_of(run, folder));
  return folder;
}

/// What a run that did not come to its end leaves behind: no figures.
void end_early(const RunFolder& folder, bool failed) {
  RunRecord record = load_run_record(folder).value();
  record.figures.reset();
  record.stages = {{failed ? "corrected student" : "teacher", {}, {}, failed}};
  save_run_record(folder, record);
  if (failed) {
    write_file(folder.file(run_file::kProofRounds),
               "round,looked_at,demand,violations\n1,lattice,property 1,0\n"
               "1,lattice,property 3,23994\n");
    return;
  }
  std::filesystem::remove(folder.file(run_file::kReport));
}

void edit_the_first_profit(const RunFolder& folder) {
  const auto path = folder.file(run_file::kDays);
  std::string text = read_file(path);
  const std::size_t row = text.find('\n') + 1;
  const std::size_t profit = text.find("2023", row);
  text.insert(text.find(',', profit) + 1, "9");
  write_file(path, text);
}

}  // namespace

void write_many_runs(const std::filesystem::path& folder,
                     const std::vector<NamedEvaluation>& baselines) {
  const std::string quiet =
      "[[rule]]\nname = \"quiet hours\"\nhours = \"10:00-11:00\"\nis = \"idle\"\n";
  for (const RunByHand& run : std::initializer_list<RunByHand>{
           {"run-10", 2, 1, "b0000000"},
           {"run-9", 10, 0.97, "a0000000", "[train]\nmethod = \"dqn\"\n"},
           {"ruled", 1, 0.9, "d0000000", {}, quiet},
           {"losing", 3, -0.5, "c0000000"},
           {"other-days", 4, 1.1, "e0000000", {}, {}, true}}) {
    write_run(folder, run, baselines);
  }
  end_early(write_run(folder, {"failed", 5, 1, "f0000000", {}, quiet}, baselines), true);
  end_early(write_run(folder, {"stopped", 6, 1, "f0000000"}, baselines), false);
  edit_the_first_profit(write_run(folder, {"edited", 7, 1, "f0000000"}, baselines));
}

}  // namespace bess
