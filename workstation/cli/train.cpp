// bess-train train: prices in, teacher out.
#include "workstation/rl/train.h"

#include <fmt/format.h>

#include <memory>

#include "workstation/cli/commands.h"
#include "workstation/cli/common_options.h"
#include "workstation/io/file.h"
#include "workstation/io/user_error.h"
#include "workstation/report/curves.h"

namespace bess {
namespace {

struct Options {
  CommonOptions common;
  std::string prices;
  std::string out;
  std::string curve_out;
  std::optional<std::string> method;
  std::optional<long> steps;
  bool json = false;
};

void run(const Options& options) {
  RunConfig config = options.common.resolve();
  if (options.method) config.train.method = parse_method(*options.method);
  if (options.steps) config.train.steps = *options.steps;
  require_writable(options.out);
  const MarketSteps market = make_market_steps(read_minute_file(options.prices), config.market);
  watch_interruption();
  TrainResult result = train_teacher(market, config.battery, config.train, interruption());
  if (result.curve.empty()) throw Interrupted{};  // nothing was validated yet, nothing to save
  result.teacher.provenance = training_provenance(options.prices, config.train, result);
  save_teacher(options.out, result.teacher);
  if (!options.curve_out.empty()) write_file(options.curve_out, training_curve_csv(result.curve));
  warn_narrow_support(config.train, result);
  if (options.json) {
    fmt::print(R"({{"teacher": {}, "method": "{}", "steps": {}, "best_step": {}, )"
               R"("validation_eur_per_day_per_mwh": {:.4f}, "seconds": {:.2f}}})"
               "\n",
               json_quote(options.out), method_name(config.train.method), result.curve.back().step,
               result.best_step, result.best_validation_eur_per_day_per_mwh, result.seconds);
  } else {
    fmt::print("{}: {}, best at step {} of {}: {:.1f} EUR/day/MWh on validation days, {:.0f} s\n",
               options.out, method_name(config.train.method), result.best_step,
               result.curve.back().step, result.best_validation_eur_per_day_per_mwh,
               result.seconds);
  }
  if (interruption()) throw Interrupted{};
}

}  // namespace

std::string training_provenance(const std::string& prices, const TrainOptions& options,
                                const TrainResult& result) {
  return fmt::format("bess-train {} {} on {}, seed {}, best at step {} of {}", BESS_VERSION,
                     method_name(options.method), std::filesystem::path(prices).filename().string(),
                     options.seed, result.best_step, options.steps);
}

void warn_narrow_support(const TrainOptions& options, const TrainResult& result) {
  constexpr double kEdgeMassMax = 0.01;
  if (options.method != Method::kC51 || result.curve.back().edge_mass_frac <= kEdgeMassMax) return;
  fmt::print(stderr,
             "bess-train: warning: {:.1f} % of the value distribution sits on the end atoms; widen "
             "[train] value_min_eur_per_h and value_max_eur_per_h\n",
             100 * result.curve.back().edge_mass_frac);
}

void add_train_command(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("train", "Train the teacher, C51 or DQN");
  command->add_option("--prices", options->prices, "Minute file (.csv or .csv.gz)")->required();
  command->add_option("--out", options->out, "Teacher file to write")->required();
  command->add_option("--method", options->method, "c51 (default) or dqn")
      ->check(CLI::IsMember({"c51", "dqn"}));
  command->add_option("--steps", options->steps, "Gradient steps")->check(CLI::PositiveNumber);
  command->add_option("--curve-out", options->curve_out, "CSV of the learning curve");
  command->add_flag("--json", options->json, "One JSON object");
  options->common.add_market(*command);
  options->common.add_config(*command);
  options->common.add_seed_and_threads(*command);
  command->footer(
      "Ctrl-C saves the best so far and exits with 3.\n"
      "Examples:\n"
      "  bess-train train --prices market.csv.gz --out teacher.bin\n"
      "  bess-train train --prices market.csv.gz --method dqn --seed 7 --out dqn.bin");
  command->callback([options] { run(*options); });
}

}  // namespace bess
