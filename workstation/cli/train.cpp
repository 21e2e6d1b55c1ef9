// bess-train train: teacher from prices.
#include "workstation/policy/rl/train.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/user_error.h"
#include "workstation/base/answer.h"
#include "workstation/cli/commands.h"
#include "workstation/report/figures/curves.h"
#include "workstation/runs/chain/chain_steps.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/run/run_record.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

struct TrainArguments {
  CommonOptions common;
  PriceInput price_input;
  DayAheadInput day_ahead;
  std::string prices;
  std::string out;
  std::string curve_out;
  std::optional<std::string> method;
  std::optional<long> steps;
  bool resume = false;
  bool json = false;
};

fs::path checkpoint_path(const fs::path& out) { return out.string() + ".checkpoint"; }
/// Inputs of the weights; a checkpoint is valid for one identity only.
std::string identity_of(const RunConfig& config, const MinuteSeries& series,
                        const std::string& day_ahead) {
  std::string text = fmt::format("bess-train {}\nseed {}\nthreads {}\nprices {}\n", BESS_VERSION,
                                 config.train.seed, config.train.threads, prices_hash(series));
  if (config.train.context == ContextKind::kOutlook) {
    text += fmt::format("day-ahead {}\n", file_mark(day_ahead));
  }
  for (const auto& [key, value] : config_entries(config))
    text += fmt::format("{} {}\n", key, value);
  return text;
}

std::string result_json(const fs::path& out, const RunConfig& config, const TrainResult& result) {
  return answer("teacher", {{"teacher", out.string()},
                            {"method", method_name(config.train.method)},
                            {"seed", config.train.seed},
                            {"steps", result.curve.back().step},
                            {"best_step", result.best_step},
                            {"validation_eur_per_day_per_mwh",
                             Decimals{result.best_validation_eur_per_day_per_mwh, 4}},
                            {"seconds", Decimals{result.seconds, 2}}})
      .line();
}

/// Trains with the configuration's seed; keeps a checkpoint next to `out` until the end.
TrainResult train_one(const fs::path& out, const TrainArguments& options, const RunConfig& config,
                      const MinuteSeries& series, const MarketSteps& market) {
  const CheckpointOptions checkpoint{checkpoint_path(out), options.resume,
                                     identity_of(config, series, options.day_ahead.path)};
  TrainResult result =
      train_teacher(market, config.battery, config.train, watch_from_first_call(), checkpoint);
  result.teacher.provenance = training_provenance(options.prices, config.train, result);
  result.teacher.learnt_for = learnt_for(config, prices_hash(series));
  if (!result.curve.empty()) {
    save_teacher(out, result.teacher);
    if (!options.curve_out.empty()) {
      write_file(options.curve_out, training_curve_csv(result.curve));
    }
  }
  if (interruption()) {
    fmt::print(stderr, "{} saved: repeat the command with --resume to continue\n",
               checkpoint.path.string());
    throw Interrupted{};
  }
  end_when_interrupted();  // everything is saved
  std::error_code error;
  fs::remove(checkpoint.path, error);  // a leftover only wastes space
  warn_narrow_support(config.train, result);
  return result;
}

void run_train(const TrainArguments& options) {
  RunConfig config = options.common.resolve(options.day_ahead.context_unless_said());
  if (options.method) config.train.method = parse_method(*options.method);
  if (options.steps) config.train.steps = *options.steps;
  warn_long_training(config);
  require_distinct({{"--out", options.out},
                    {"--curve-out", options.curve_out},
                    {"the checkpoint", checkpoint_path(options.out)}},
                   {{"--prices", options.prices},
                    {"--day-ahead", options.day_ahead.path},
                    {"--config", options.common.config_path}});
  require_writable(options.out);
  if (!options.curve_out.empty()) require_writable(options.curve_out);
  const FolderLock folder_lock(fs::path(options.out).parent_path(),
                               FolderLock::LockScope::kOneFile);
  const FileLock lock(options.out);
  const MinuteSeries series = options.price_input.read(options.prices);
  MarketSteps market = market_of(series, config.market, options.prices);
  options.day_ahead.attach_to(market, series, options.price_input.accepted(), config.market);
  warn_untrained_months(market, config.train.context == ContextKind::kMonth);
  const TrainResult result = train_one(options.out, options, config, series, market);
  if (options.json) {
    fmt::print("{}\n", result_json(options.out, config, result));
  } else {
    fmt::print("{}: {}, kept at step {} of {}: {:.1f} EUR/day/MWh on validation days, {:.0f} s\n",
               options.out, method_name(config.train.method), result.best_step,
               result.curve.back().step, result.best_validation_eur_per_day_per_mwh,
               result.seconds);
  }
}

}  // namespace

void add_train_command(ProgramCommand& app) {
  auto options = std::make_shared<TrainArguments>();
  ProgramCommand command = app.subcommand("train", "train a teacher: C51, DQN or SDP");
  command.option("--prices", options->prices, "minute file (.csv or .csv.gz)").required();
  options->price_input.add(command);
  options->day_ahead.add(command);
  command.option("--out", options->out, "teacher file to write").required();
  command.option("--method", options->method, "training method (default c51)")
      .one_of({"c51", "dqn", "sdp"});
  command.option("--steps", options->steps, "gradient steps (default: [train] steps)").positive();
  command.option("--curve-out", options->curve_out, "output file for the training curve (CSV)");
  command.flag("--resume", options->resume, "resume from OUT.checkpoint; the result is identical");
  command.flag("--json", options->json, "one JSON object");
  options->common.add_all(command);
  command.footer(
      "Ctrl-C saves the best teacher and a checkpoint, and exits with 3; --resume continues.\n"
      "Examples:\n"
      "  bess-train train --prices market.csv.gz --out teacher.bin\n"
      "  bess-train train --prices market.csv.gz --method sdp --out program.bin\n"
      "  bess-train train --prices market.csv.gz --day-ahead day_ahead.csv --out outlook.bin\n"
      "  bess-train train --prices market.csv.gz --config workstation/config/paper.toml --out "
      "paper.bin");
  command.runs([options] { run_train(*options); });
}

}  // namespace bess
