#include "workstation/sweep/run_task.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <set>

#include "shared/host/user_error.h"
#include "workstation/chain/chain_steps.h"
#include "workstation/market/series/judged_prices.h"
#include "workstation/run/run_stages.h"
#include "workstation/sweep/sweep_plan.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using namespace run_file;

/// What a lean task leaves: what is exported and what it earned; or where its proof failed.
const std::set<std::string> kLeanFiles{kRecord,      kConfig, kStudent,         kHeader,
                                       kTable,       kDays,   kUnprovedStudent, kUnprovedViolations,
                                       kProofRounds, kTimes};

/// That nobody else works in.
fs::path make_own_folder(const fs::path& parts) {
  fs::create_directories(parts);
  std::string name = (parts / "XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) fail("{}: {}", name, std::strerror(errno));
  return name;
}

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using Log = std::unique_ptr<std::FILE, CloseFile>;

Log open_log(const fs::path& path) {
  fs::create_directories(path.parent_path());
  Log log(std::fopen(path.c_str(), "a"));
  if (!log) fail("{}: {}", path.string(), std::strerror(errno));
  return log;
}

/// A rename never replaces a folder that holds something.
void publish(const SweepFolder& folder, int task, const fs::path& own) {
  const fs::path result = folder.result(task);
  std::error_code error;
  fs::rename(own, result, error);
  if (!error || is_complete(folder, task)) return;
  if (fs::exists(result)) fs::rename(result, own.string() + ".half");
  fs::rename(own, result);
}

/// Prices go by their content: what a file is called changes no byte of a result.
RunRecord record_of(const SweepRecord& sweep, const SweepTask& task, const RunConfig& config) {
  RunRecord record;
  record.prices = "prices of the sweep";
  record.prices_name = sweep.prices;
  record.identity = identity_of(config, sweep.prices, "");
  if (sweep.kind == kLean) record.identity.emplace_back(kStagesKey, kLean);
  const std::string fold = task.value(setting::kFold);
  if (!fold.empty()) record.identity.emplace_back(kFoldKey, fold);
  return record;
}

MinuteSeries prices_of(const SweepFolder& folder, const SweepRecord& sweep) {
  const std::string name = folder.prices().string();
  MinuteSeries series = read_judged_minutes(name, AcceptedFindings::all());
  if (prices_hash(series) == sweep.prices) return series;
  fail("{}: holds other prices ({}) than the sweep was planned with ({})", name,
       prices_hash(series), sweep.prices);
}

}  // namespace

bool is_complete(const SweepFolder& folder, int task) {
  return fs::exists(folder.result(task) / kRecord);
}

bool is_proved(const SweepFolder& folder, int task) {
  return is_complete(folder, task) && fs::exists(folder.result(task) / kStudent);
}

bool complete_task(const SweepFolder& folder, int task, const TaskWork& work) {
  if (is_complete(folder, task)) return false;
  const Log log = open_log(folder.log(task));
  std::error_code ignored;
  try {
    const fs::path own = make_own_folder(folder.parts(task));
    work(own, log.get());
    publish(folder, task, own);
  } catch (const std::exception& error) {
    if (!is_complete(folder, task)) {  // else another was first, and cleared up
      fmt::print(log.get(), "{}{}\n", kFailedLine, error.what());
      throw;
    }
  }
  // Of those who died, or are too late. Two that clear up at once may each give up on the other's.
  for (int tries = 0; tries < 10 && fs::exists(folder.parts(task), ignored); ++tries) {
    fs::remove_all(folder.parts(task), ignored);
  }
  fs::remove(folder.log(task), ignored);
  return true;
}

bool run_task(const SweepFolder& folder, int number) {
  const SweepRecord sweep = load_own_sweep(folder);
  const std::vector<SweepTask> tasks = load_tasks(folder);
  if (number < 1 || number > std::ssize(tasks)) {
    fail("there is no task {}: {} has {} of them", number, folder.tasks().string(), tasks.size());
  }
  const SweepTask& task = tasks[static_cast<std::size_t>(number - 1)];
  setenv("SOURCE_DATE_EPOCH", fmt::format("{}", sweep.date_utc_s).c_str(), 1);
  return complete_task(folder, number, [&](const fs::path& at, std::FILE* log) {
    const MinuteSeries series = prices_of(folder, sweep);
    const RunConfig config = config_of_task(folder, load_run_config(folder.base()), task);
    const RunRecord record = record_of(sweep, task, config);
    save_run_record({at}, record);
    try {
      RunStages({at}, record, series, log).finish();
    } catch (const ProofFailed& failed) {
      fmt::print(log, "{}\n", failed.what());
    }
    if (!record.is_lean()) return;
    for (const auto& entry : fs::directory_iterator(at)) {
      if (!kLeanFiles.contains(entry.path().filename().string())) fs::remove_all(entry.path());
    }
  });
}

}  // namespace bess
