// bess-train run: whole chain in one folder, from prices to weight header and report.
#include <fmt/core.h>

#include <ctime>
#include <memory>
#include <optional>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/run/run_backtest.h"
#include "workstation/runs/run/run_plan.h"
#include "workstation/runs/run/run_report.h"
#include "workstation/runs/run/run_stages.h"
#include "workstation/runs/run/training_scope.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

struct RunArguments {
  RunRequest request;
  bool json = false;
};

/// Simulated prices have no real date; their file says so.
void warn_old_prices(const RunPlan& plan) {
  if (plan.record.prices == run_file::kSimulatedPrices) return;
  const std::string warning = old_prices(plan.series, std::time(nullptr));
  if (warning.empty()) return;
  const std::string prices = read_file(plan.folder.path / plan.record.prices);
  if (prices.starts_with(fmt::format("# {}", kSimulatedProvenance))) return;
  fmt::print(stderr, "bess-train: warning: {}\n", warning);
}

/// Plans, locks the folder and runs all stages.
void run_one(const RunRequest& request, std::FILE* messages) {
  std::optional<FolderLock> lock;
  if (fs::is_directory(request.out)) lock.emplace(request.out);  // before its content is read
  RunPlan plan = plan_run(request);
  if (!plan.record.teacher_file.empty()) {
    Entries here = circumstances_of(plan.record.identity);
    here.emplace_back("prices", plan.record.value("prices"));
    warn_learnt_otherwise(plan.record.teacher_file, here);
  }
  warn_old_prices(plan);
  if (plan.record.teacher_file.empty()) warn_long_training(plan.record.config(plan.folder));
  require_writable(plan.folder.record());
  if (!lock) lock.emplace(plan.folder.path);
  fmt::print(messages, "[1/{}] prices: {} ({} minutes)\n", RunStages::count(),
             plan.record.prices_name, plan.series.size());
  if (!load_run_record(plan.folder)) save_run_record(plan.folder, plan.record);
  end_when_interrupted(how_to_go_on(plan.folder, plan.record));
  RunStages(plan.folder, plan.record, plan.series, messages).finish();
}

void run_single(const RunArguments& options) {
  run_one(options.request, options.json ? stderr : stdout);
  const RunFolder folder{options.request.out};
  if (options.json) {
    fmt::print("{}\n", summary_json(load_run_summary(folder)).line());
  } else {
    fmt::print("\n{}\n{}: report.html, student_weights.h and all other files of this run\n",
               with_run_folder(read_file(folder.file(run_file::kSummary)), folder.path),
               folder.path.string());
  }
}

}  // namespace

void add_run_command(ProgramCommand& app) {
  auto options = std::make_shared<RunArguments>();
  RunRequest& request = options->request;
  ProgramCommand command =
      app.subcommand("run", "run the whole chain: train, correct, prove, export, evaluate, report");
  command.option("--prices", request.prices, "minute file (default: a built-in simulated year)");
  request.price_input.add(command);
  request.day_ahead.add(command);
  request.rule_files.add(command, "rule files: operator rules to train and prove as well");
  command.option("--out", request.out, "run folder").value_name("DIR").required();
  command.flag("--resume", request.resume,
               "resume the run in --out; options not given keep their value");
  command.option("--from-teacher", request.from_teacher,
                 "skip training; use this teacher (file or run folder)");
  command.flag("--json", options->json, "one JSON object");
  request.common.add_all(command);
  command.footer(
      "Each finished stage is saved: --resume continues after Ctrl-C, a full disk or a failed "
      "proof.\n" +
      RunStages::help() +
      "Examples:\n"
      "  bess-train run --out runs/first\n"
      "  bess-train run --resume --out runs/first\n"
      "  bess-train run --prices market.csv.gz --day-ahead day_ahead.csv --out runs/outlook\n"
      "  bess-train run --prices market.csv.gz --config my.toml --seed 7 --out runs/second\n"
      "  bess-train run --prices market.csv.gz --from-teacher runs/second --config "
      "other.toml --out runs/third\n"
      "Several seeds: bess-train sweep plan --seeds 3");
  command.runs([options] { run_single(*options); });
}

}  // namespace bess
