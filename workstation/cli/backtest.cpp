// bess-train backtest: walk-forward evaluation; each month is traded by policies fitted on the days
// before it.
#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/base/parallel_for.h"
#include "workstation/base/progress.h"
#include "workstation/cli/commands.h"
#include "workstation/correction/student/correct_and_prove.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/correction/student/student_policy.h"
#include "workstation/report/backtest/walk_forward.h"
#include "workstation/report/backtest_report.h"
#include "workstation/report/comparison.h"
#include "workstation/runs/chain/chain_steps.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/chain/policy_factory.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/run/run_backtest.h"
#include "workstation/runs/run/run_record.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

/// Policy name of a fold's teacher.
constexpr const char* kTeacherName = "teacher";

std::vector<std::string> compared_with_the_chain() {
  std::vector<std::string> names = baseline_names(kUnlessToldOther);
  names.insert(names.end(), {kChainName, kForesightName});
  return names;
}

struct BacktestArguments {
  CommonOptions common;
  PriceInput price_input;
  std::vector<std::string> prices;
  std::vector<std::string> policies = compared_with_the_chain();
  DayAheadInput day_ahead;
  FoldPlan plan{.window_days = 120};
  bool weekly = false;
  bool and_day_reset = false;
  std::string out;
  bool json = false;
};

/// Inputs of every fold's student, except the fold itself.
std::string identity_of(const RunConfig& config, const MinuteSeries& series,
                        const BacktestArguments& options) {
  const std::string day_ahead =
      config.train.context == ContextKind::kOutlook
          ? fmt::format(", day-ahead {}", file_mark(options.day_ahead.path))
          : "";
  const auto& [window_days, lag_days, traded_days] = options.plan;
  return fmt::format("# bess-train {}, prices {:08x}{}, window {} days{}{}, seed {}\n{}",
                     BESS_VERSION, prices_checksum(series), day_ahead, window_days,
                     lag_days == 0 ? "" : fmt::format(", {} days before", lag_days),
                     traded_days == 0 ? "" : fmt::format(", for {} days", traded_days),
                     config.train.seed, format_run_config(config));
}

/// A folder belongs to one configuration, so that its folds can be reused.
void claim_folder(const fs::path& folder, const std::string& identity) {
  const fs::path path = folder / "backtest.toml";
  if (!fs::exists(path)) return write_file(path, identity);
  if (read_file(path) != identity) {
    fail(
        "{}: contains folds of other prices, window, seed or configuration (see its "
        "backtest.toml); choose another --out",
        folder.string());
  }
}

fs::path model_path(const fs::path& folder, const Fold& fold, std::string_view name) {
  return folder / (fold.month + (name == kChainName ? ".student.json" : ".teacher.bin"));
}

bool is_learnt(std::string_view policy) { return policy == kChainName || policy == kTeacherName; }

/// Train, correct, prove. Throws UserError when the proof fails.
StudentFile distil_fold(const Teacher& teacher, const Fold& fold, const RunConfig& config) {
  const Matrix visited = visited_inputs(teacher, fold.market, config.battery, config.distil);
  const CorrectionResult corrected =
      correct_and_prove(teacher, visited, config.distil, interruption(),
                        validation_score(fold.market, config.battery, config.initial_soc_frac));
  return require_proof(corrected, config.distil.method, fold.month + ": ").file();
}

/// Inputs and output folder of the folds' training.
struct Learning {
  RunConfig config;
  const MinuteSeries& series;
  const std::string& prices;  ///< name
  const fs::path& folder;
  bool and_student;
};

/// The teacher's file names its prices and training days; so does its student's.
Teacher teacher_of_fold(const Fold& fold, const Learning& of) {
  TrainResult trained = train_teacher(fold.market, of.config.battery, of.config.train,
                                      [] { return interruption().load(); });
  const std::vector<MarketDay> days = fold.market.fitted_days();
  trained.teacher.provenance =
      fmt::format("{}, days {} to {}", training_provenance(of.prices, of.config.train, trained),
                  days.front().date(), days.back().date());
  trained.teacher.learnt_for =
      learnt_for(of.config, prices_hash(of.series, fold.market.span_of(days)));
  return std::move(trained.teacher);
}

/// Trains the requested models of a fold that do not exist yet.
void learn_fold(const Fold& fold, const Learning& of) {
  const fs::path path = model_path(of.folder, fold, kTeacherName);
  if (!fs::exists(path)) save_teacher(path, teacher_of_fold(fold, of));
  const fs::path student = model_path(of.folder, fold, kChainName);
  if (!of.and_student || fs::exists(student)) return;
  save_student(student, distil_fold(load_teacher(path), fold, of.config));
}

/// Trains missing models in parallel. One thread per fold keeps each fold bit-identical.
void learn_folds(const Folds& folds, Learning of, const std::vector<std::string>& policies) {
  const auto is_missing = [&](const Fold& fold) {
    return std::ranges::any_of(policies, [&](const std::string& name) {
      return is_learnt(name) && !fs::exists(model_path(of.folder, fold, name));
    });
  };
  std::vector<const Fold*> missing;
  for (const Fold& fold : folds.traded) {
    if (is_missing(fold)) missing.push_back(&fold);
  }
  const int threads = of.config.train.threads;
  of.config.set_threads(1);
  Progress progress("train", "folds", static_cast<double>(folds.traded.size()),
                    static_cast<double>(folds.traded.size() - missing.size()));
  parallel_for(missing.size(), threads, [&](std::size_t i) {
    learn_fold(*missing[i], of);
    progress.advance(missing[i]->month);
  });
}

void run_backtest(const BacktestArguments& options) {
  const RunConfig config = options.common.resolve(options.day_ahead.context_unless_said());
  const fs::path folder = options.out;
  require_distinct(
      named_files("--out", folder,
                  {"backtest.csv", "backtest_days.csv", "backtest.json", "backtest.html"}),
      named_paths(
          "--prices", options.prices,
          {{"--config", options.common.config_path}, {"--day-ahead", options.day_ahead.path}}));
  std::vector<std::string> baselines = options.policies;
  std::erase_if(baselines, is_learnt);
  require_policies(baselines);
  require_outlook(baselines, options.day_ahead.path);
  const MinuteSeries series = options.price_input.read_joined(options.prices).series;
  const std::string prices =
      options.prices.size() == 1
          ? options.prices.front()
          : fmt::format("{} and {} more", options.prices.front(), options.prices.size() - 1);
  MarketSteps market = market_of(series, config.market, prices);
  options.day_ahead.attach_to(market, series, options.price_input.accepted(), config.market);
  const Folds folds = make_folds(market, options.plan);
  require_writable(folder / "backtest.csv");
  const FolderLock lock(folder);
  claim_folder(folder, identity_of(config, series, options));
  end_when_interrupted("trained months are kept: repeat the command to continue");
  const bool and_student =
      std::ranges::find(options.policies, kChainName) != options.policies.end();
  learn_folds(folds, {config, series, prices, folder, and_student}, options.policies);
  std::vector<BacktestMonth> months;
  for (const Fold& fold : folds.traded) {
    months.push_back({fold.month, fold.market.fitted_days().size(), regimes_of(fold)});
    warn_unknown_regimes(fold.month, fold.market, fold.market, fold.market.days_of(Split::kTest));
  }
  BacktestResults results{{},
                          std::move(months),
                          folds.skipped,
                          options.plan.window_days,
                          fmt::format("{} on {}, prices {:08x}, seed {}", BESS_VERSION,
                                      counted(options.prices.size(), "file"),
                                      prices_checksum(series), config.train.seed),
                          learning_identity(prices_hash(series), config)};
  Progress progress("trade", "policies", static_cast<double>(options.policies.size()));
  for (const std::string& name : options.policies) {
    const FoldPolicy make = [&](const Fold& fold) {
      const std::string model = is_learnt(name) ? model_path(folder, fold, name).string() : name;
      return make_policy(model, fold.market, config.battery);
    };
    results.policies.push_back(walk_forward(
        name, folds, make, config.battery, config.initial_soc_frac, market, options.and_day_reset));
    progress.advance(name);
  }
  write_file(folder / "backtest.csv", backtest_csv(results));
  write_file(folder / "backtest_days.csv", backtest_days_csv(results));
  write_file(folder / "backtest.json", backtest_json(results).text());
  write_backtest_page(results, folder);
  const std::string run = folder.has_parent_path() ? folder.parent_path().string() : ".";
  if (folder.filename() == kRunsBacktest && fs::exists(RunFolder{run}.record())) {
    fmt::print(stderr, "'bess-train report --run {}' adds it to the run's report\n", run);
  }
  if (options.json) {
    fmt::print("{}\n", backtest_json(results).line());
  } else {
    fmt::print("{}{}: backtest.html, with the same data in CSV and JSON\n",
               format_backtest_table(results), folder.string());
  }
}

}  // namespace

void add_backtest_command(ProgramCommand& app) {
  auto options = std::make_shared<BacktestArguments>();
  ProgramCommand command = app.subcommand(
      "backtest", "walk-forward backtest: fit on a window, trade the next month, repeat");
  command.option("--prices", options->prices, "minute files or downloads; periods may be separate")
      .required();
  options->price_input.add(command);
  command.option("--out", options->out, "folder for results and students")
      .value_name("DIR")
      .required();
  command
      .option("--policy", options->policies,
              std::string("policies; gains are relative to the first. ") + kChainName +
                  " is the whole chain, retrained for each month, " + kTeacherName +
                  " its teacher; the others: " + policy_help())
      .with_default();
  command
      .option("--window-days", options->plan.window_days, "training window before each month, days")
      .range(30, 3650)
      .with_default();
  command
      .option("--lag-days", options->plan.lag_days,
              "gap between training window and traded month, days (default 0; a refresh has 30)")
      .range(0, 365);
  command.flag("--weekly", options->weekly, "refit every seven days instead of every month");
  options->day_ahead.add(command);
  command.flag("--day-reset", options->and_day_reset,
               "also report day-reset accounting: each day starts at the same SoC");
  command.flag("--json", options->json, "one JSON object");
  options->common.add_all(command);
  command.footer(
      "Trained months are kept: after an interruption, repeat the command to continue. Each fold "
      "trains on one thread, so that its result is bit-identical.\n"
      "Examples:\n"
      "  bess-train backtest --prices 2023.csv.gz 2024.csv.gz --out backtests/first\n"
      "  bess-train backtest --prices 2024.csv.gz --window-days 60 --policy rbc sdp --out quick\n"
      "  bess-train backtest --prices 2024.csv.gz --day-ahead day_ahead.csv.gz --policy sdp "
      "sdp-outlook --out outlook");
  command.runs([options] {
    if (options->weekly) options->plan.traded_days = 7;
    run_backtest(*options);
  });
}

}  // namespace bess
