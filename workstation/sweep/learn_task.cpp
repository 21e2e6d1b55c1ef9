#include "workstation/sweep/learn_task.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <set>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/chain/chain_steps.h"
#include "workstation/market/series/judged_prices.h"
#include "workstation/run/run_stages.h"
#include "workstation/sweep/sweep_plan.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using namespace run_file;

constexpr const char* kLog = "log.txt";

/// What a lean task leaves: what is exported and what it earned; or where its proof failed.
const std::set<std::string> kLeanFiles{kRecord,      kConfig, kStudent,         kHeader,
                                       kTable,       kDays,   kUnprovedStudent, kUnprovedViolations,
                                       kProofRounds, kTimes};

struct LearningTask {
  const SweepRecord& sweep;
  const SweepTask& task;
  const RunConfig& config;
  const MinuteSeries& series;
};

/// Prices go by their content: what a file is called changes no byte of a result.
RunRecord record_of(const LearningTask& of) {
  RunRecord record;
  record.prices = "prices of the sweep";
  record.prices_name = of.sweep.prices;
  record.identity = identity_of(of.config, of.sweep.prices, "");
  if (of.sweep.kind == kLean) record.identity.emplace_back(kStagesKey, kLean);
  const std::string fold = of.task.value(setting::kFold);
  if (!fold.empty()) record.identity.emplace_back(kFoldKey, fold);
  return record;
}

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

void publishable(const fs::path& folder, bool is_lean) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool is_kept = is_lean ? kLeanFiles.contains(name) : name != kLog;
    if (!is_kept) fs::remove_all(entry.path(), error);
  }
}

/// In what an earlier attempt left, when that is of the very same task.
void learn(const LearningTask& of, const fs::path& folder) {
  const RunFolder run{folder};
  RunRecord record = record_of(of);
  std::optional<RunRecord> there;
  try {
    there = load_run_record(run);
  } catch (const UserError&) {  // damaged: it is worth no more than its time
  }
  if (there && differences(there->identity, record.identity).empty()) {
    record = *there;
  } else {
    fs::remove_all(folder);
    fs::create_directories(folder);
    save_run_record(run, record);
  }
  const std::unique_ptr<std::FILE, CloseFile> log(std::fopen((folder / kLog).c_str(), "a"));
  if (!log) fail("{}: cannot write here", (folder / kLog).string());
  try {
    RunStages(run, record, of.series, log.get()).finish();
  } catch (const ProofFailed& failed) {
    fmt::print(log.get(), "{}\n", failed.what());
  }
  publishable(folder, record.is_lean());
}

}  // namespace

LearningTasks::LearningTasks(const SweepFolder& folder)
    : folder_(folder),
      sweep_(load_own_sweep(folder)),
      base_(load_run_config(folder.base())),
      tasks_(read_file(folder.tasks())) {
  setenv("SOURCE_DATE_EPOCH", fmt::format("{}", sweep_.date_utc_s).c_str(), 1);
}

const MinuteSeries& LearningTasks::prices() {
  if (series_) return *series_;
  const std::string name = folder_.prices().string();
  MinuteSeries series = read_judged_minutes(name, AcceptedFindings::all());
  if (prices_hash(series) != sweep_.prices) {
    fail("{}: holds other prices ({}) than the sweep was planned with ({})", name,
         prices_hash(series), sweep_.prices);
  }
  return series_.emplace(std::move(series));
}

TaskWork LearningTasks::work(int number) {
  return
      [this, task = parse_one_task(tasks_, number, folder_.tasks().string())](const fs::path& at) {
        learn({sweep_, task, config_of_task(folder_, base_, task), prices()}, at);
      };
}

RunHereResult learn_here(const SweepFolder& folder, const std::vector<int>& tasks, int jobs) {
  if (tasks.empty()) return {};
  LearningTasks learning(folder);
  learning.prices();
  const auto one = [&](int task) {
    say_end(folder, task, attempt_task(folder, task, learning.work(task)));
  };
  return run_here(folder, tasks, jobs, one, stdout);
}

void say_end(const SweepFolder& folder, int task, TaskEnd end) {
  const std::string name = folder.result(task).string();
  switch (end) {
    case TaskEnd::kAlreadyThere:
      fmt::print("task {}: is there already: {}\n", task, name);
      return;
    case TaskEnd::kSame:
      fmt::print("task {}: another copy was first, and made the same: {}\n", task, name);
      return;
    case TaskEnd::kPublished:
      fmt::print("task {}: {}: {}\n", task,
                 is_proved(folder.result(task)) ? "proved" : "not proved", name);
      return;
    case TaskEnd::kDifferent:
      break;
  }
  fail(
      "task {}: another copy was first, and made something else: {} has both; is one of them of "
      "another machine or program?",
      task, folder.different().string());
}

bool is_proved(const fs::path& result) {
  std::error_code error;
  return fs::exists(result / kStudent, error);
}

}  // namespace bess
