// bess-train report: figures and tables of a run, made again from its folder.
#include <fmt/core.h>

#include <memory>
#include <optional>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/chain/chain_steps.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/run/run_plan.h"
#include "workstation/runs/run/run_stages.h"

namespace bess {
namespace {

void run_report(const std::string& path, const std::string& prices) {
  const RunFolder folder{path};
  std::optional<RunRecord> record = load_run_record(folder);
  if (!record) {
    fail("{}: holds no run, there is no {} in it; make one with 'bess-train run --out {}'", path,
         run_file::kRecord, path);
  }
  std::vector<GivenPath> outputs;
  for (const std::string& name : RunStages::files())
    outputs.push_back({"--run", folder.file(name)});
  if (record->prices != run_file::kSimulatedPrices) {
    require_distinct(outputs, {{"--prices", prices}});
  }
  // The run accepted what it accepted.
  const MinuteSeries series = prices.empty()
                                  ? prices_of_run(*record, folder, AcceptedFindings::all())
                                  : read_judged_minutes(prices, AcceptedFindings::all());
  if (const std::string hash = prices_hash(series); hash != record->value("prices")) {
    fail("{}: are not the prices of this run: {}, and the run has {}",
         prices.empty() ? record->prices : prices, hash, record->value("prices"));
  }
  if (!record->day_ahead.empty() &&
      file_mark(folder.path / record->day_ahead) != record->value(kDayAheadKey)) {
    fail("{}: are not the day-ahead prices of this run, which has {}", record->day_ahead,
         record->value(kDayAheadKey));
  }
  const FolderLock lock(folder.path);
  RunStages stages(folder, std::move(*record), series, stderr);
  stages.report_again();
  fmt::print("{}\n{}/report.html\n", stages.summary(), path);
}

}  // namespace

void add_report_command(ProgramCommand& app) {
  auto path = std::make_shared<std::string>();
  auto prices = std::make_shared<std::string>();
  ProgramCommand command =
      app.subcommand("report", "Make a run's figures, tables and report.html again");
  command.option("--run", *path, "Run folder").required();
  command.option("--prices", *prices, "Minute file, if it moved since the run");
  command.footer("Examples:\n  bess-train report --run runs/first");
  command.runs([path, prices] { run_report(*path, *prices); });
}

}  // namespace bess
