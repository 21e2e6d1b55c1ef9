// bess-train run: the whole chain into one folder, from prices to the weight header and the report.
#include <fmt/core.h>

#include <memory>

#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/user_error.h"
#include "workstation/cli/chain_steps.h"
#include "workstation/cli/commands.h"
#include "workstation/cli/common_options.h"
#include "workstation/cli/price_input.h"
#include "workstation/cli/rule_files.h"
#include "workstation/cli/run_folder.h"
#include "workstation/cli/run_report.h"
#include "workstation/market/model/quarter_hours_to_minutes.h"
#include "workstation/market/model/simulated_market.h"
#include "workstation/market/series/local_date.h"
#include "workstation/student/correct_and_prove.h"
#include "workstation/student/export.h"

namespace bess {
namespace {

/// The built-in market: one local year, so that every month is seen.
constexpr LocalDate kBuiltInStart{2023, 1, 1};
constexpr int kBuiltInDays = 365;
constexpr std::uint64_t kBuiltInSeed = 1;

struct RunArguments {
  CommonOptions common;
  PriceInput price_input;
  RuleFiles rule_files;
  std::string prices;
  std::string out;
};

void announce(int stage, const std::string& text) {
  fmt::print("[{}/6] {}\n", stage, text);
  std::fflush(stdout);
}

MinuteSeries built_in_market(const RunFolder& folder) {
  const SimulationPeriod period{local_midnight_utc_s(kBuiltInStart),
                                local_midnight_utc_s(add_days(kBuiltInStart, kBuiltInDays))};
  MinuteSeries series =
      minutes_on_quarter_hours(simulate_quarter_hours(period, kBuiltInSeed), kBuiltInSeed);
  write_minute_file(folder.simulated_prices(), series,
                    fmt::format("Simulated, not real: built-in market, seed {}", kBuiltInSeed));
  return series;
}

/// Everything is trained and proved before the folder gets a student or a header.
RunResults learn(const RunConfig& config, MarketSteps market, const std::string& prices_name) {
  announce(2, fmt::format("train the {} teacher", method_name(config.train.method)));
  TrainResult trained = train_teacher(market, config.battery, config.train, interruption());
  if (interruption()) throw Interrupted{};
  warn_narrow_support(config.train, trained);
  trained.teacher.provenance = training_provenance(prices_name, config.train, trained);
  fmt::print("      best at step {}: {:.1f} EUR/day/MWh on validation days, {:.0f} s\n",
             trained.best_step, trained.best_validation_eur_per_day_per_mwh, trained.seconds);

  announce(3, "distil without correction, for comparison");
  const Matrix visited = visited_inputs(trained.teacher, market, config.battery, config.distil);
  DistilOptions plain_options = config.distil;
  plain_options.correct = false;
  CorrectionResult plain =
      correct_and_prove(trained.teacher, visited, plain_options, interruption());
  if (interruption()) throw Interrupted{};
  const Certificate& sampled = student_of(plain.verdict).certificate;
  fmt::print("      {} violations in {} states looked at\n", sampled.violations(),
             sampled.states_checked);

  announce(4, "correct while distilling, and prove");
  CorrectionResult corrected =
      correct_and_prove(trained.teacher, visited, config.distil, interruption(),
                        validation_score(market, config.battery, config.initial_soc_frac));
  if (interruption()) throw Interrupted{};
  const Certificate& certificate = require_proof(corrected, config.distil.method).certificate();
  fmt::print("      no violation over {} states, {} round{}\n", certificate.states_checked,
             corrected.violations_by_round.size(),
             corrected.violations_by_round.size() == 1 ? "" : "s");
  return {config,
          std::move(market),
          std::move(trained.teacher),
          std::move(plain.verdict),
          std::move(corrected.verdict),
          std::move(trained.curve),
          std::move(corrected.curve)};
}

std::string manifest(const RunResults& run, const std::string& prices) {
  const StudentFile& corrected = student_of(run.corrected);
  const Certificate& certificate = corrected.certificate;
  const Certificate& plain = student_of(run.plain).certificate;
  return Json::object({{"version", BESS_VERSION},
                       {"prices", prices},
                       {"seed", run.config.train.seed},
                       {"threads", run.config.train.threads},
                       {"provenance", corrected.provenance},
                       {"weights_hash", fmt::format("{:08x}", student_weights_hash(corrected.net))},
                       {"states_checked", certificate.states_checked},
                       {"states_checked_plain", plain.states_checked},
                       {"violations_plain", plain.violations()},
                       {"violations_corrected", certificate.violations()}})
      .text();
}

void run_chain(const RunArguments& options) {
  const RunFolder folder{options.out};
  RunConfig config = options.common.resolve();
  options.rule_files.apply(config, config.train.context);
  watch_interruption();
  const bool built_in = options.prices.empty();
  const std::string prices =
      built_in ? folder.simulated_prices().string()
               : std::filesystem::absolute(options.prices).lexically_normal().string();
  require_writable(folder.header());
  announce(1, built_in ? "draw the built-in market" : "read " + options.prices);
  MarketSteps market = make_market_steps(
      built_in ? built_in_market(folder) : options.price_input.read(options.prices), config.market);
  warn_untrained_months(market, config.train.context == ContextKind::kMonth);
  write_file(folder.config(), format_run_config(config));
  const RunResults results =
      learn(config, std::move(market), built_in ? "built-in market" : options.prices);

  announce(5, "export");
  save_teacher(folder.teacher(), results.teacher);
  save_student(folder.plain_student(), student_of(results.plain));
  save_student(folder.student(), student_of(results.corrected));
  write_file(folder.training_curve(), training_curve_csv(results.training_curve));
  write_file(folder.distil_curve(), distil_curve_csv(results.distil_curve));
  write_file(folder.header(), format_weight_header(std::get<ProvedStudent>(results.corrected)));
  write_file(folder.manifest(), manifest(results, prices));

  announce(6, "evaluate on test days and report");
  const std::string table = write_run_report(results, folder);
  fmt::print("\n{}\n{}: report.html, student_weights.h and everything else of this run\n", table,
             folder.path.string());
}

}  // namespace

void add_run_command(ProgramCommand& app) {
  auto options = std::make_shared<RunArguments>();
  ProgramCommand command = app.subcommand(
      "run", "The whole chain into one folder: train, correct, prove, export, evaluate, report");
  command.option("--prices", options->prices, "Minute file; without it a built-in simulated year");
  options->price_input.add(command);
  options->rule_files.add(command, "Rule files: your own rules, learnt and proved as well");
  command.option("--out", options->out, "Run folder").required();
  options->common.add_market(command);
  options->common.add_config(command);
  options->common.add_seed_and_threads(command);
  command.footer(
      "Examples:\n"
      "  bess-train run --out runs/first\n"
      "  bess-train run --prices market.csv.gz --config my.toml --seed 7 --out runs/second");
  command.runs([options] { run_chain(*options); });
}

}  // namespace bess
