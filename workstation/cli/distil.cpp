// bess-train distil: teacher in, corrected and proved integer student out.
#include <fmt/core.h>

#include <memory>

#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/user_error.h"
#include "workstation/cli/commands.h"
#include "workstation/cli/common_options.h"
#include "workstation/report/curves.h"
#include "workstation/student/correct_and_prove.h"

namespace bess {
namespace {

struct Options {
  CommonOptions common;
  std::string prices;
  std::string teacher;
  std::string out;
  std::string curve_out;
  std::string risk = "mean";
  std::optional<double> omega;
  std::optional<int> epochs;
  bool plain = false;
  bool json = false;
};

void print_result(const Options& options, const CorrectedStudent& student) {
  const Certificate& c = student.certificate;
  if (options.json) {
    const Json json = Json::object({{"student", options.out},
                                    {"corrected", !options.plain},
                                    {"rounds", student.violations_by_round.size()},
                                    {"states_checked", c.states_checked},
                                    {"violations_property_1", c.violations_property_1},
                                    {"violations_property_2", c.violations_property_2},
                                    {"violations_property_3", c.violations_property_3}});
    fmt::print("{}\n", json.line());
    return;
  }
  fmt::print("{}: {} states checked, violations {} / {} / {} after {} round{}\n", options.out,
             c.states_checked, c.violations_property_1, c.violations_property_2,
             c.violations_property_3, student.violations_by_round.size(),
             student.violations_by_round.size() == 1 ? "" : "s");
}

void run(const Options& options) {
  RunConfig config = options.common.resolve();
  if (options.omega) config.distil.omega = *options.omega;
  if (options.epochs) config.distil.epochs = *options.epochs;
  config.distil.correct = !options.plain;
  require_writable(options.out);
  const Teacher teacher = load_teacher(options.teacher, parse_risk(options.risk));
  const MarketSteps market = make_market_steps(read_minute_file(options.prices), config.market);
  watch_interruption();
  const Matrix visited = visited_inputs(teacher, market, config.battery, config.distil.seed);
  const CorrectedStudent student =
      correct_and_prove(teacher, visited, config.distil, interruption());
  if (interruption()) throw Interrupted{};
  if (!options.plain && student.certificate.violations() != 0) {
    fail(
        "{} violations are left after {} rounds, nothing was written; raise [correction] "
        "price_slope and soc_slope or [distil] repair_rounds",
        student.certificate.violations(), student.violations_by_round.size());
  }
  const std::string risk = teacher.risk.is_mean() ? "" : ", risk " + options.risk;
  save_student(options.out, student_file(student, config.distil, teacher.provenance + risk));
  if (!options.curve_out.empty()) write_file(options.curve_out, distil_curve_csv(student.curve));
  print_result(options, student);
}

}  // namespace

StudentFile student_file(const CorrectedStudent& student, const DistilOptions& options,
                         const std::string& teacher_provenance) {
  return {student.net, options.correction.low_price_eur_per_mwh,
          options.correction.high_price_eur_per_mwh,
          fmt::format("{}; {} omega {:g}, {} epochs, seed {}", teacher_provenance,
                      options.correct ? "corrected," : "plain,", options.omega, options.epochs,
                      options.seed)};
}

void add_distil_command(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("distil", "Correct the teacher while distilling it, until proved");
  command->add_option("--prices", options->prices, "Minute file (.csv or .csv.gz)")->required();
  command->add_option("--teacher", options->teacher, "Teacher file")->required();
  command->add_option("--out", options->out, "Student file to write")->required();
  command
      ->add_option("--risk", options->risk,
                   "What of the teacher is distilled: mean, or cvar:ALPHA, the mean of the worst "
                   "share ALPHA")
      ->capture_default_str();
  command->add_option("--omega", options->omega, "Larger follows the teacher more closely");
  command->add_option("--epochs", options->epochs, "Before the first proof")
      ->check(CLI::PositiveNumber);
  command->add_flag("--plain", options->plain, "No correction: what the teacher alone would give");
  command->add_option("--curve-out", options->curve_out, "CSV of the losses");
  command->add_flag("--json", options->json, "One JSON object");
  options->common.add_market(*command);
  options->common.add_config(*command);
  options->common.add_seed_and_threads(*command);
  command->footer(
      "Examples:\n"
      "  bess-train distil --prices market.csv.gz --teacher teacher.bin --out student.json\n"
      "  bess-train distil --prices market.csv.gz --teacher teacher.bin --plain --out plain.json");
  command->callback([options] { run(*options); });
}

}  // namespace bess
