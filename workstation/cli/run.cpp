// bess-train run: whole chain in one folder, from prices to weight header and report.
// bess-train report: regenerated figures and tables of a run.
// bess-train refresh: retraining of a run on the latest prices; adopts the candidate unless it is
// worse.
// bess-train runs: comparison of finished runs.
#include <fmt/core.h>

#include <algorithm>
#include <ctime>
#include <memory>
#include <optional>

#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/chain/chain_steps.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/run/refresh.h"
#include "workstation/runs/run/run_backtest.h"
#include "workstation/runs/run/run_plan.h"
#include "workstation/runs/run/run_record.h"
#include "workstation/runs/run/run_report.h"
#include "workstation/runs/run/run_stages.h"

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

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> folders;
  bool json = false;
  std::string html;
};

/// A folder of runs is replaced by its runs.
std::vector<RunFolder> runs_in(const std::string& name) {
  std::vector<RunFolder> runs;
  if (!fs::exists(RunFolder{name}.record()) && fs::is_directory(name)) {
    for (const auto& entry : fs::directory_iterator(name)) {
      const RunFolder run{entry.path()};
      if (fs::exists(run.record())) runs.push_back(run);
    }
  }
  if (runs.empty()) return {RunFolder{name}};
  std::ranges::sort(runs, [](const RunFolder& a, const RunFolder& b) {
    const std::string x = a.path.string();
    const std::string y = b.path.string();
    return std::pair(x.size(), x) < std::pair(y.size(), y);  // run-9 before run-10
  });
  return runs;
}

std::vector<RunFolder> all_runs(const Options& options) {
  std::vector<RunFolder> all;
  for (const std::string& name : options.folders) {
    std::ranges::move(runs_in(name), std::back_inserter(all));
  }
  return all;
}

void write_page(const Options& options) {
  require_distinct({{"--html", options.html}}, named_paths("folders", options.folders));
  require_writable(options.html);
  std::vector<RunSummary> runs;
  for (const RunFolder& folder : all_runs(options)) runs.push_back(load_any_run(folder));
  write_file(options.html, runs_page(runs, options.html));
  const auto finished =
      std::ranges::count_if(runs, [](const RunSummary& run) { return !run.evaluations.empty(); });
  fmt::print("{}: {}, {} with figures\n", options.html, counted(runs.size(), "run"), finished);
}

void compare(const Options& options) {
  if (!options.html.empty()) return write_page(options);
  std::vector<RunSummary> runs;
  for (const RunFolder& folder : all_runs(options)) runs.push_back(load_run_summary(folder));
  if (!options.json) {
    fmt::print("{}", format_runs_table(runs));
    return;
  }
  for (const RunSummary& run : runs) fmt::print("{}\n", summary_json(run).line());
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

void add_refresh_command(ProgramCommand& app) {
  auto options = std::make_shared<RefreshRequest>();
  ProgramCommand command = app.subcommand(
      "refresh", "retrain on the latest prices; writes a candidate run next to the run");
  command.option("--run", options->run, "run folder").required();
  command.flag("--adopt", options->adopt,
               "replace the run with the candidate unless it is significantly worse");
  command
      .option("--window-days", options->window_days,
              "training window, days; at least half must have prices")
      .range(30, 3650)
      .with_default();
  command.option("--prices", options->prices,
                 "minute files or downloads (default: download the latest prices)");
  options->price_input.add(command);
  options->day_ahead.add(command);
  command.option("--base-url", options->source, "API root of the imbalance prices").with_default();
  command.option("--day-ahead-base-url", options->day_ahead_source, "API root of day-ahead prices")
      .with_default();
  command.footer(
      "The latest 30 days evaluate the candidate; training uses the days before them. The\n"
      "candidate RUN.proposal is a complete run. Adopted, it becomes RUN, and the previous run\n"
      "RUN.before-DATE; rejected, it becomes RUN.refused-DATE. After an interruption, repeat the\n"
      "command to continue.\n"
      "Examples:\n"
      "  bess-train refresh --run runs/site\n"
      "  bess-train refresh --run runs/site --prices 2024.csv.gz 2025.csv.gz --adopt");
  command.runs([options] { refresh(*options); });
}

void add_runs_commands(ProgramCommand& app) {
  auto options = std::make_shared<Options>();
  ProgramCommand runs = app.subcommand("runs", "finished runs: compare");
  runs.requires_subcommand();
  ProgramCommand command =
      runs.subcommand("compare", "compare results and settings of finished runs");
  command.option("folders", options->folders, "run folders, or folders of run folders")
      .value_name("DIR")
      .required();
  command.flag("--json", options->json, "JSON, one line per run");
  command.option("--html", options->html,
                 "write a sortable HTML table instead, including failed and stopped runs");
  command.footer(
      "Gains are day-by-day differences to the first run.\n"
      "Examples:\n"
      "  bess-train runs compare runs/first runs/second\n"
      "  bess-train runs compare runs/seeds --json\n"
      "  bess-train runs compare runs --html runs/all.html");
  command.runs([options] { compare(*options); });
}

}  // namespace bess
