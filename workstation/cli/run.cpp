// bess-train run: the whole chain into one folder, from prices to the weight header and the report.
#include <fmt/core.h>

#include <memory>
#include <optional>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/chain/chain_steps.h"
#include "workstation/chain/config_plausibility.h"
#include "workstation/chain/folder_lock.h"
#include "workstation/chain/interruption.h"
#include "workstation/cli/commands.h"
#include "workstation/run/learnt_for.h"
#include "workstation/run/run_plan.h"
#include "workstation/run/run_seeds.h"
#include "workstation/run/run_stages.h"
#include "workstation/run/stage_table.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

struct RunArguments {
  RunRequest request;
  std::string out;
  int seeds = 1;
  bool json = false;
};

/// Plans, claims the folder and goes through all stages.
void run_one(const RunRequest& request, std::FILE* messages) {
  std::optional<FolderLock> lock;
  if (fs::is_directory(request.out)) lock.emplace(request.out);  // before what it holds is judged
  RunPlan plan = plan_run(request);
  if (!plan.record.teacher_file.empty()) {
    Entries here = circumstances_of(plan.record.identity);
    here.emplace_back("prices", plan.record.value("prices"));
    warn_learnt_otherwise(plan.record.teacher_file, here);
  }
  if (plan.record.teacher_file.empty()) warn_long_training(plan.record.config(plan.folder));
  require_writable(plan.folder.record());
  if (!lock) lock.emplace(plan.folder.path);
  fmt::print(messages, "[{}/{}] prices: {} ({} minutes)\n", stage_named(stage_name::kPrices).number,
             stage_count(), plan.record.prices_name, plan.series.size());
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
    fmt::print("\n{}\n{}: report.html, student_weights.h and everything else of this run\n",
               read_file(folder.file(run_file::kSummary)), folder.path.string());
  }
}

/// Every seed's request; all are planned before the first one writes.
std::vector<RunRequest> requests_of(const RunArguments& options) {
  const RunFolder whole{options.request.out};
  if (fs::exists(whole.record())) {
    fail("{}: holds a run of one seed; give another --out", whole.path.string());
  }
  std::vector<RunRequest> requests;
  const std::uint64_t first = options.request.common.seed.value_or(1);
  for (int i = 0; i < options.seeds; ++i) {
    RunRequest request = options.request;
    request.common.seed = first + static_cast<std::uint64_t>(i);
    request.out = seed_folder(options.request.out, *request.common.seed);
    (void)plan_run(request);
    requests.push_back(std::move(request));
  }
  return requests;
}

void run_seeds(const RunArguments& options) {
  std::vector<RunSummary> finished;
  std::vector<std::string> failures;
  std::vector<UnprovedSeed> unproved;
  for (const RunRequest& request : requests_of(options)) {
    std::FILE* messages = options.json ? stderr : stdout;
    fmt::print(messages, "seed {}\n", *request.common.seed);
    try {
      run_one(request, messages);
      finished.push_back(load_run_summary({request.out}));
    } catch (const ProofFailed& failed) {  // the other seeds may do better
      failures.push_back(fmt::format("seed {}: {}", *request.common.seed, failed.what()));
      fmt::print(stderr, "bess-train: {}\n", failures.back());
      const std::string reason = failed.what();
      unproved.push_back({request.out.filename().string(), reason.substr(0, reason.find('\n'))});
    }
  }
  const std::vector<Band> bands = bands_of(finished);
  if (!finished.empty()) write_seeds_report(options.request.out, finished, unproved);
  if (options.json) {
    for (const RunSummary& run : finished) fmt::print("{}\n", summary_json(run).line());
    fmt::print("{}\n", bands_json(bands, finished.size()));
  } else if (!finished.empty()) {
    fmt::print("\n{}\n{}: seeds.html and seeds.csv, and a folder a seed\n",
               format_bands(bands, finished.size()), options.request.out.string());
  }
  if (!failures.empty()) {
    fail("{} of {} seeds were not proved; the first is {}", failures.size(), options.seeds,
         failures.front());
  }
}

}  // namespace

void add_run_command(ProgramCommand& app) {
  auto options = std::make_shared<RunArguments>();
  RunRequest& request = options->request;
  ProgramCommand command = app.subcommand(
      "run", "The whole chain into one folder: train, correct, prove, export, evaluate, report");
  command.option("--prices", request.prices, "Minute file; without it a built-in simulated year");
  request.price_input.add(command);
  request.day_ahead.add(command);
  request.rule_files.add(command, "Rule files: your own rules, learnt and proved as well");
  command.option("--out", options->out, "Run folder").required();
  command.flag("--resume", request.resume,
               "Go on with the folder's run, to the same bytes; what is not given is the folder's");
  command.option("--from-teacher", request.from_teacher,
                 "Start at the correction, with this teacher: its file or its run's folder");
  command
      .option("--seeds", options->seeds,
              "This many runs, from --seed on, in OUT/seed-1 and so on, and their bands")
      .range(1, 1000);
  command.flag("--json", options->json,
               "One JSON object; with --seeds one a line and seed, and bands");
  request.common.add_market(command);
  request.common.add_config(command);
  request.common.add_seed_and_threads(command);
  command.footer(
      "Each stage is written when it is done: after Ctrl-C, a full disk or a failed proof nothing "
      "is lost.\n" +
      stages_help() +
      "Examples:\n"
      "  bess-train run --out runs/first\n"
      "  bess-train run --resume --out runs/first\n"
      "  bess-train run --prices market.csv.gz --day-ahead day_ahead.csv --out runs/outlook\n"
      "  bess-train run --prices market.csv.gz --config my.toml --seed 7 --out runs/second\n"
      "  bess-train run --prices market.csv.gz --from-teacher runs/second --config "
      "other.toml --out runs/third\n"
      "  bess-train run --prices market.csv.gz --seeds 3 --out runs/seeds");
  command.runs([options] {
    options->request.out = options->out;
    options->seeds > 1 ? run_seeds(*options) : run_single(*options);
  });
}

}  // namespace bess
