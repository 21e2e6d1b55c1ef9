// bess-train runs: comparison of finished runs.
#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "shared/host/file.h"
#include "shared/host/text.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/run/run_report.h"

namespace bess {
namespace {

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
