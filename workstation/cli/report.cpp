// bess-train report: regenerated figures and tables of a run.
#include <fmt/core.h>

#include <memory>

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
  RunRecord record = existing_run_record(folder);
  if (record.prices != run_file::kSimulatedPrices) {
    require_distinct(named_files("--run", folder.path, RunStages::files()), {{"--prices", prices}});
  }
  // Findings were already accepted or rejected when the run was made.
  const MinuteSeries series = prices.empty()
                                  ? prices_of_run(record, folder, AcceptedFindings::all())
                                  : read_judged_minutes(prices, AcceptedFindings::all());
  if (const std::string hash = prices_hash(series); hash != record.value("prices")) {
    fail("{}: not the prices of this run: {}, but the run has {}; give its file with --prices",
         prices.empty() ? record.prices : prices, hash, record.value("prices"));
  }
  if (!record.day_ahead.empty() &&
      file_mark(folder.path / record.day_ahead) != record.value(kDayAheadKey)) {
    fail("{}: not the day-ahead prices of this run, which has {}; restore the file",
         record.day_ahead, record.value(kDayAheadKey));
  }
  const FolderLock lock(folder.path);
  RunStages(folder, std::move(record), series, stderr).report_again();
  fmt::print("{}\n{}/report.html\n", read_file(folder.file(run_file::kSummary)), path);
}

}  // namespace

void add_report_command(ProgramCommand& app) {
  auto path = std::make_shared<std::string>();
  auto prices = std::make_shared<std::string>();
  ProgramCommand command =
      app.subcommand("report", "regenerate figures, tables and report.html of a run");
  command.option("--run", *path, "run folder").required();
  command.option("--prices", *prices, "minute file, if its path changed since the run");
  command.footer("Examples:\n  bess-train report --run runs/first");
  command.runs([path, prices] { run_report(*path, *prices); });
}

}  // namespace bess
