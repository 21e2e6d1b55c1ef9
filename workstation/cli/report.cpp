// bess-train report: figures and tables of a run, made again from its folder.
#include <fmt/core.h>

#include <memory>

#include "shared/host/file.h"
#include "shared/host/json_reader.h"
#include "shared/host/user_error.h"
#include "workstation/cli/commands.h"
#include "workstation/cli/common_options.h"
#include "workstation/cli/run_report.h"
#include "workstation/market/series/judged_prices.h"

namespace bess {
namespace {

std::string prices_of_run(const RunFolder& folder) {
  const Json json = Json::parse(read_file(folder.manifest()));
  return JsonReader(json.value(), folder.manifest().string(),
                    "a run's manifest (make the run again)")
      .text("prices");
}

void run_report(const std::string& path, const std::string& prices) {
  const RunFolder folder{path};
  if (!std::filesystem::exists(folder.config())) {
    fail("{}: holds no run, there is no config.toml in it; make one with 'bess-train run --out {}'",
         path, path);
  }
  CommonOptions common;
  common.config_path = folder.config().string();
  const RunConfig config = common.resolve();
  const std::string prices_path = prices.empty() ? prices_of_run(folder) : prices;
  // The run accepted what it accepted.
  MarketSteps market =
      make_market_steps(read_judged_minutes(prices_path, AcceptedFindings::all()), config.market);
  Teacher teacher = load_teacher(folder.teacher());
  Verdict plain = prove(load_student(folder.plain_student()), config.train.threads);
  Verdict corrected = prove(load_student(folder.student()), config.train.threads);
  const RunResults results{
      config,
      std::move(market),
      std::move(teacher),
      std::move(plain),
      std::move(corrected),
      parse_training_curve_csv(read_file(folder.training_curve()),
                               folder.training_curve().string()),
      parse_distil_curve_csv(read_file(folder.distil_curve()), folder.distil_curve().string())};
  fmt::print("{}\n{}/report.html\n", write_run_report(results, folder), path);
}

}  // namespace

void add_report_command(ProgramCommand& app) {
  auto path = std::make_shared<std::string>();
  auto prices = std::make_shared<std::string>();
  ProgramCommand command =
      app.subcommand("report", "Make a run's figures, tables and report.html again");
  command.option("--run", *path, "Run folder").required();
  command.option("--prices", *prices, "Minute file, if it moved since the run");
  command.footer("Examples:\n  bess-train report --run runs/first");
  command.runs([path, prices] { run_report(*path, *prices); });
}

}  // namespace bess
