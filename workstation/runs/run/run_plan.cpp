#include "workstation/runs/run/run_plan.h"

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/runs/chain/chain_steps.h"
#include "workstation/runs/run/run_report.h"
#include "workstation/runs/run/run_stages.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

std::string absolute(const std::string& path) {
  return fs::absolute(path).lexically_normal().string();
}

/// Checks the output folder of a new run.
void require_free(const RunFolder& folder, const RunRequest& request) {
  require_distinct(named_files("--out", folder.path, RunStages::files()),
                   {{"--prices", request.prices},
                    {"--day-ahead", request.day_ahead.path},
                    {"--config", request.common.config_path},
                    {"--from-teacher", request.from_teacher}});
  for (const std::string& name : RunStages::files()) {
    if (!fs::exists(folder.file(name))) continue;
    fail("{}: contains {} but no {}, so its origin is unknown; choose another --out",
         folder.path.string(), name, run_file::kRecord);
  }
}

/// Throws unless the folder contains the requested run and it may be resumed.
void require_same(const RunRecord& there, const RunRecord& asked, const RunFolder& folder,
                  bool resume) {
  const std::string name = folder.path.string();
  const std::string other = differences(there.identity, asked.identity);
  if (!other.empty())
    fail("{}: contains another run: {}; choose another --out (only --resume continues this one)",
         name, other);
  if (!resume) {
    fail("{}: contains this run, {}; add --resume to continue it, or choose another --out", name,
         there.state());
  }
}

/// An edited config.toml is an error, because resuming would silently restore it.
void require_unedited_configuration(const RunRecord& there, const RunFolder& folder) {
  const fs::path path = folder.file(run_file::kConfig);
  if (!fs::exists(path)) return;
  const std::string edits =
      differences(configuration_of(there.identity), config_entries(load_run_config(path)),
                  "in the run", "in the file");
  if (edits.empty()) return;
  fail(
      "{}: edited: {}; a run keeps its initial configuration: restore the file, or use it for "
      "another run, --config {} --out ANOTHER",
      path.string(), edits, path.string());
}

RunConfig config_of(const RunRequest& request, const RunRecord* there, const RunFolder& folder) {
  const bool knows_day_ahead = there != nullptr && !there->day_ahead.empty();
  const ContextKind unless_said =
      knows_day_ahead ? ContextKind::kOutlook : request.day_ahead.context_unless_said();
  if (there == nullptr) return request.common.resolve(unless_said);
  const RunConfig known = there->config(folder);
  CommonOptions common = request.common;
  if (!common.seed) common.seed = known.train.seed;
  if (!common.threads) common.threads = known.train.threads;
  return common.config_path.empty() ? common.resolve(known) : common.resolve(unless_said);
}

}  // namespace

MinuteSeries prices_of_run(const RunRecord& record, const RunFolder& folder,
                           const AcceptedFindings& accepted) {
  if (record.prices == run_file::kSimulatedPrices) return built_in_market();
  const fs::path prices = folder.path / record.prices;
  if (!fs::exists(prices)) {
    fail("{}: no such minute file; if it moved, name it with --prices", prices.string());
  }
  return read_judged_minutes(prices, accepted);
}

RunPlan plan_run(const RunRequest& request) {
  RunPlan plan{{request.out}, {}, {}};
  const std::optional<RunRecord> there = load_run_record(plan.folder);
  const RunRecord* known = request.resume && there ? &*there : nullptr;
  if (!there) require_free(plan.folder, request);
  if (known != nullptr) require_unedited_configuration(*known, plan.folder);
  RunConfig config = config_of(request, known, plan.folder);
  request.rule_files.apply(config, config.train.context);
  RunRecord& record = plan.record;
  record.prices = known ? known->prices : run_file::kSimulatedPrices;
  record.prices_name = known ? known->prices_name : kBuiltInMarketName;
  if (known) record.day_ahead = known->day_ahead;
  if (!request.prices.empty()) {
    record.prices = absolute(request.prices);
    record.prices_name = fs::path(request.prices).filename().string();
  }
  if (!request.day_ahead.path.empty()) record.day_ahead = absolute(request.day_ahead.path);
  if (config.train.context == ContextKind::kOutlook && record.day_ahead.empty()) {
    fail(
        "[train] context = \"outlook\" plans on day-ahead prices: add their file with "
        "--day-ahead");
  }
  std::string teacher_hash;
  if (!request.from_teacher.empty()) {
    record.teacher_file = absolute(request.from_teacher);
    if (fs::is_directory(record.teacher_file)) {  // run folder, with or without trailing slash
      record.teacher_file = absolute(request.from_teacher + "/" + run_file::kTeacher);
    }
    teacher_hash = file_mark(record.teacher_file);
    if (teacher_hash.empty()) fail("--from-teacher {}: cannot be read", record.teacher_file);
    (void)load_teacher(record.teacher_file);  // validates it
  } else if (known && !known->teacher_file.empty()) {
    teacher_hash = known->value("teacher");
  }
  // An existing run already accepted its findings; other prices are refused below.
  const AcceptedFindings accepted =
      there ? AcceptedFindings::all() : request.price_input.accepted();
  plan.series = prices_of_run(record, plan.folder, accepted);
  record.identity = identity_of(config, prices_hash(plan.series), teacher_hash);
  if (!record.day_ahead.empty()) {
    (void)read_day_ahead(plan.folder.path / record.day_ahead, plan.series, accepted,
                         config.market.day_ahead_published_min);
    record.identity.emplace_back(kDayAheadKey, file_mark(plan.folder.path / record.day_ahead));
  }
  if (there) {
    require_same(*there, record, plan.folder, request.resume);
    record = *there;
  } else {
    require_test_days(market_of(plan.series, config.market, record.prices), record.prices);
  }
  return plan;
}

}  // namespace bess
