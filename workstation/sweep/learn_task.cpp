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
  SweepRecord sweep;
  SweepTask task;
  RunConfig config;
  MinuteSeries series;
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

TaskWork learning_work(const SweepFolder& folder, int task) {
  auto of = std::make_shared<LearningTask>();
  of->sweep = load_own_sweep(folder);
  of->task = parse_one_task(read_file(folder.tasks()), task, folder.tasks().string());
  setenv("SOURCE_DATE_EPOCH", fmt::format("{}", of->sweep.date_utc_s).c_str(), 1);
  return [of, folder](const fs::path& at) {
    of->config = config_of_task(folder, load_run_config(folder.base()), of->task);
    of->series = read_judged_minutes(folder.prices().string(), AcceptedFindings::all());
    if (prices_hash(of->series) != of->sweep.prices) {
      fail("{}: holds other prices ({}) than the sweep was planned with ({})",
           folder.prices().string(), prices_hash(of->series), of->sweep.prices);
    }
    learn(*of, at);
  };
}

bool is_proved(const fs::path& result) {
  std::error_code error;
  return fs::exists(result / kStudent, error);
}

}  // namespace bess
