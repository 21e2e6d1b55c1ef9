// bess-train distil: from a teacher to a corrected and proved integer student.
#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/base/answer.h"
#include "workstation/cli/commands.h"
#include "workstation/correction/student/correct_and_prove.h"
#include "workstation/correction/student/prove.h"
#include "workstation/report/figures/curves.h"
#include "workstation/runs/chain/chain_steps.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/run/run_record.h"

namespace bess {
namespace {

struct DistilArguments {
  CommonOptions common;
  PriceInput price_input;
  DayAheadInput day_ahead;
  RuleFiles rule_files;
  std::string prices;
  std::string teacher;
  std::string out;
  std::string curve_out;
  std::optional<double> omega;
  std::optional<int> epochs;
  bool plain = false;
  bool json = false;
};

void print_result(const DistilArguments& options, const CorrectionResult& result) {
  const Certificate& c = student_of(result.verdict).certificate;
  const std::size_t rounds = result.rounds.size();
  if (options.json) {
    const std::uint32_t hash = student_weights_hash(student_of(result.verdict).net);
    Json json = answer("student", {{"student", options.out},
                                   {"weights_hash", fmt::format("{:08x}", hash)},
                                   {"corrected", !options.plain},
                                   {"rounds", rounds}});
    add_certificate(c, json);
    fmt::print("{}\n", json.line());
    return;
  }
  fmt::print("{}: {} states checked, violations {} / {} / {} after {}\n", options.out,
             c.states_checked, c.violations_of(1), c.violations_of(2), c.violations_of(3),
             counted(rounds, "round"));
  fmt::print("{}", rule_count_lines(c));
}

void run_distil(const DistilArguments& options) {
  RunConfig config = options.common.resolve();
  if (options.omega) config.distil.omega = *options.omega;
  if (options.epochs) config.distil.epochs = *options.epochs;
  config.distil.correct = !options.plain;
  require_distinct({{"--out", options.out}, {"--curve-out", options.curve_out}},
                   {{"--prices", options.prices},
                    {"--teacher", options.teacher},
                    {"--day-ahead", options.day_ahead.path},
                    {"--config", options.common.config_path}});
  require_writable(options.out);
  if (!options.curve_out.empty()) require_writable(options.curve_out);
  Teacher teacher = load_teacher(options.teacher);
  teacher.learnt_for = learnt_for_of(options.teacher);
  warn_learnt_otherwise(options.teacher, circumstances_of(config_entries(config)));
  options.rule_files.apply(config, teacher.context.kind);
  const MinuteSeries series = options.price_input.read(options.prices);
  MarketSteps market = market_of(series, config.market, options.prices);
  options.day_ahead.attach_to(market, series, options.price_input.accepted(), config.market);
  const Matrix visited = visited_inputs(teacher, market, config.battery, config.distil);
  const CorrectionResult result =
      correct_and_prove(teacher, visited, config.distil, interruption(),
                        validation_score(market, config.battery, config.initial_soc_frac),
                        [&](const ProofRound& round, const RoundsState& state) {
                          if (!options.plain) fmt::print(stderr, "{}\n", round_line(round, state));
                        });
  const StudentFile& student = student_of(result.verdict);
  if (!options.plain && !std::holds_alternative<ProvedStudent>(result.verdict)) {
    std::filesystem::path kept = options.out;
    kept.replace_filename(kept.stem().string() + "_unproved" + kept.extension().string());
    save_student(kept, student);
    require_proof(result, config.distil.method, "", "; the student is kept as " + kept.string());
  }
  save_student(options.out, student);
  if (!options.curve_out.empty()) write_file(options.curve_out, distil_curve_csv(result.curve));
  print_result(options, result);
}

}  // namespace

void add_distil_command(ProgramCommand& app) {
  auto options = std::make_shared<DistilArguments>();
  ProgramCommand command = app.subcommand(
      "distil", "distil a teacher into a student that satisfies the properties, and prove it");
  command.option("--prices", options->prices, "minute file (.csv or .csv.gz)").required();
  options->price_input.add(command);
  options->day_ahead.add(command);
  options->rule_files.add(command, "rule files: operator rules to train and prove as well");
  command.option("--teacher", options->teacher, "teacher file").required();
  command.option("--out", options->out, "student file to write").required();
  command.option("--omega", options->omega,
                 "trade-off of the optimisation layer; larger follows the teacher more closely "
                 "(default: [distil] omega)");
  command
      .option("--epochs", options->epochs,
              "epochs before the first proof (default: [distil] epochs)")
      .positive();
  command.flag("--plain", options->plain,
               "distil without correction; count violations on a sample");
  command.option("--curve-out", options->curve_out, "output file for the losses (CSV)");
  command.flag("--json", options->json, "one JSON object");
  options->common.add_all(command);
  command.footer(
      "Examples:\n"
      "  bess-train distil --prices market.csv.gz --teacher teacher.bin --out student.json\n"
      "  bess-train distil --prices market.csv.gz --teacher teacher.bin --rules my_rules.toml "
      "--out student.json\n"
      "  bess-train distil --prices market.csv.gz --teacher teacher.bin --plain --out plain.json");
  command.runs([options] { run_distil(*options); });
}

}  // namespace bess
