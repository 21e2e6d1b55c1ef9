// bess-train omega-sweep: measured trade-off of the paper's loss.
#include <fmt/core.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/user_error.h"
#include "workstation/base/answer.h"
#include "workstation/cli/commands.h"
#include "workstation/correction/student/correct_and_prove.h"
#include "workstation/correction/student/student_policy.h"
#include "workstation/report/figures/walk_forward_figure.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/chain/price_input.h"

namespace bess {
namespace {

constexpr double kOmegaMin = 1e-8;  // as [distil] omega
constexpr double kOmegaMax = 1;
constexpr const char* kCsvName = "omega_sweep.csv";

struct OmegaSweepArguments {
  CommonOptions common;
  PriceInput price_input;
  std::string prices;
  std::string teacher;
  std::string out;
  std::vector<std::string> omegas = {"1e-6", "1e-5", "1e-4", "1e-3", "1e-2", "1e-1", "1"};
  std::optional<int> epochs;
  bool json = false;
};

/// Decides as the teacher and counts decisions that the student shares.
class AgreementCounter final : public Policy {
 public:
  AgreementCounter(const Teacher& teacher, const StudentNet& student)
      : teacher_(teacher), student_(student) {}
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override {
    const Action action = teacher_.decide(step, index, soc_frac);
    ++decisions_;
    if (student_.decide(step, index, soc_frac) == action) ++agreed_;
    return action;
  }
  [[nodiscard]] double share() const {
    return static_cast<double>(agreed_) / static_cast<double>(decisions_);
  }

 private:
  TeacherPolicy teacher_;
  StudentPolicy student_;
  mutable std::int64_t decisions_ = 0;
  mutable std::int64_t agreed_ = 0;
};

/// Common inputs of all distillations and evaluations.
struct SweepContext {
  const Teacher& teacher;
  const Matrix& visited;
  const MarketSteps& market;
  std::vector<MarketDay> days;
  EvaluationOptions evaluation;

  [[nodiscard]] Evaluation carried_over(Policy& policy) const {
    return evaluate_carried_over(market, days, policy, evaluation.battery,
                                 evaluation.initial_soc_frac);
  }
};

OmegaPoint measure(const SweepContext& context, const DistilOptions& options) {
  const CorrectionResult result =
      correct_and_prove(context.teacher, context.visited, options, interruption());
  const StudentFile& student = student_of(result.verdict);
  AgreementCounter counter(context.teacher, student.net);
  evaluate(context.market, context.days, counter, context.evaluation);
  StudentPolicy policy(student.net);
  return {options.omega, student.certificate, result.curve.back().visited_loss, counter.share(),
          context.carried_over(policy)};
}

void print_json(const OmegaPoint& point, const Evaluation& teacher) {
  const PairedDifference gain = paired_difference(point.evaluation, teacher);
  Json json = answer("omega");
  json.set("omega", point.omega);
  add_certificate(point.certificate, json);
  json.set("divergence_nats", point.divergence_nats);
  json.set("agreement", Decimals{point.agreement, 6});
  json.set(key::kCarrySoc, true);
  json.set("days", point.evaluation.days.size());
  json.set(key::kProfit, Decimals{point.evaluation.profit_eur_per_day_per_mwh(), 4});
  json.set(key::kProfitError, Decimals{point.evaluation.errors().plain, 4});
  json.set(key::kProfitErrorByMonth, Decimals{point.evaluation.errors().by_month, 4});
  json.set(key::kGainOver, "teacher");
  json.set(key::kGain, Decimals{gain.mean, 4});
  json.set(key::kGainError, Decimals{gain.errors.plain, 4});
  json.set(key::kGainErrorByMonth, Decimals{gain.errors.by_month, 4});
  fmt::print("{}\n", json.line());
  std::fflush(stdout);  // each takes minutes
}

void run_omega_sweep(const OmegaSweepArguments& options) {
  const std::vector<double> omegas =
      numbers_in(options.omegas, kOmegaMin, kOmegaMax, "--omega",
                 fmt::format("numbers from {:g} to {:g}", kOmegaMin, kOmegaMax));
  RunConfig config = options.common.resolve();
  config.distil.method = CorrectionMethod::kLayer;
  config.distil.repair_rounds = 0;
  if (options.epochs) config.distil.epochs = *options.epochs;
  const std::filesystem::path out = options.out;
  require_writable(out / kCsvName);
  const Teacher teacher = load_teacher(options.teacher);
  const MarketSteps market =
      market_of(options.price_input.read(options.prices), config.market, options.prices);
  const Matrix visited = visited_inputs(teacher, market, config.battery, config.distil);
  const SweepContext context{teacher,
                             visited,
                             market,
                             market.days_of(Split::kHeldOut),
                             {config.battery, config.initial_soc_frac, true}};
  if (context.days.empty()) {
    fail("{}: no complete validation or test day (21 to the end of a month)", options.prices);
  }
  TeacherPolicy teacher_policy(teacher);
  const Evaluation of_teacher = context.carried_over(teacher_policy);
  std::vector<OmegaPoint> points;
  for (const double omega : omegas) {
    config.distil.omega = omega;
    points.push_back(measure(context, config.distil));
    if (options.json) print_json(points.back(), of_teacher);
  }
  write_file(out / kCsvName, omega_csv(points, of_teacher));
  if (!options.json) fmt::print("{}", format_omega_table(points, of_teacher));
}

}  // namespace

void add_omega_sweep_command(ProgramCommand& app) {
  auto options = std::make_shared<OmegaSweepArguments>();
  ProgramCommand command =
      app.subcommand("omega-sweep", "sweep omega: violations, fidelity and profit");
  command.option("--prices", options->prices, "minute file (.csv or .csv.gz)").required();
  options->price_input.add(command);
  command.option("--teacher", options->teacher, "teacher file").required();
  command.option("--out", options->out, "folder for omega_sweep.csv").value_name("DIR").required();
  command
      .option("--omega", options->omegas, "omega values; one distillation without repair for each")
      .with_default();
  command
      .option("--epochs", options->epochs, "epochs of each distillation (default: [distil] epochs)")
      .positive();
  command.flag("--json", options->json, "JSON, one line per omega");
  options->common.add_all(command);
  command.footer(
      "Examples:\n"
      "  bess-train omega-sweep --prices market.csv.gz --teacher teacher.bin --out sweep\n"
      "  bess-train omega-sweep --prices market.csv.gz --teacher teacher.bin --out sweep --omega "
      "1e-5 1e-4 1e-3 --epochs 200 --json");
  command.runs([options] { run_omega_sweep(*options); });
}

}  // namespace bess
