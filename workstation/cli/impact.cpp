// bess-train impact: profit of a fleet that changes the price, by its size.
#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/cli/commands.h"
#include "workstation/policy/planners/baselines.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/chain/policy_factory.h"
#include "workstation/runs/impact/impact_study.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr double kFleetMwMax = 20'000;

struct ImpactArguments {
  CommonOptions common;
  ImpactPlan plan;
  std::vector<std::string> fleet_mw;
  std::string out;
  bool json = false;
};

std::vector<double> fleets_of(const std::vector<std::string>& texts) {
  std::vector<double> fleets =
      numbers_in(texts, 0, kFleetMwMax, "--fleet-mw",
                 fmt::format("megawatts from 0 (no impact) to {:g}", kFleetMwMax));
  std::ranges::sort(fleets);
  fleets.erase(std::unique(fleets.begin(), fleets.end()), fleets.end());
  return fleets;
}

void run_impact(const ImpactArguments& options) {
  const fs::path folder = options.out;
  require_distinct(named_files("--out", folder, {"impact.csv", "impact.html"}),
                   {{"--config", options.common.config_path}});
  const RunConfig config = options.common.resolve();
  ImpactPlan plan = options.plan;
  if (!options.fleet_mw.empty()) plan.fleet_mw = fleets_of(options.fleet_mw);
  plan.threads = config.train.threads;
  require_policies(plan.policies);
  for (const std::string& policy : plan.policies) {
    if (policy == kForesightName || policy == kOutlookProgramName) {
      fail("--policy {}: the simulated fleet has no future and no day-ahead prices; choose another",
           policy);
    }
  }
  if (config.market.observation_delay_min == 0) {
    fail("[market] observation_delay_min = 0: a fleet cannot see its own future effect; use 1");
  }
  require_writable(folder / "impact.csv");
  end_when_interrupted();
  const std::vector<ImpactRow> rows =
      study_impact(plan, {.battery = config.battery,
                          .initial_soc_frac = config.initial_soc_frac,
                          .observation_delay_min = config.market.observation_delay_min});
  write_file(folder / "impact.csv", impact_csv(rows));
  write_impact_page(plan, rows, folder);
  if (options.json) {
    fmt::print("{}\n", impact_json(plan, rows).line());
  } else {
    fmt::print("{}{}: impact.html and impact.csv\n", format_impact_table(plan, rows), options.out);
  }
}

}  // namespace

void add_impact_command(ProgramCommand& app) {
  auto options = std::make_shared<ImpactArguments>();
  ImpactPlan& plan = options->plan;
  ProgramCommand command = app.subcommand(
      "impact", "simulate a fleet that changes the price: EUR/MW by fleet size and price formula");
  command.option("--out", options->out, "folder for table and page").value_name("DIR").required();
  command.option("--fleet-mw", options->fleet_mw,
                 "fleet sizes, MW; 0 has no impact (default 0 50 100 200 300 450 600 800 1200)");
  command
      .option("--policy", plan.policies,
              std::string("policies of the fleet, in equal parts: ") + policy_help())
      .with_default();
  command.option("--train-days", plan.train_days, "training days").range(10, 300).with_default();
  command.option("--test-days", plan.test_days, "test days after the training days")
      .range(1, 300)
      .with_default();
  command.option("--seeds", plan.seeds, "number of simulated markets (seeds 1 to N)")
      .range(1, 1000)
      .with_default();
  command.option("--rounds", plan.rounds, "rounds of retraining on prices that include the fleet")
      .range(0, 20)
      .with_default();
  command.flag("--json", options->json, "one JSON object");
  options->common.add_threads(command);
  command.option("--delay", options->common.delay_min, "observation delay, minutes (default 1)")
      .range(1, 5);
  options->common.add_config(command);
  command.footer(
      "Examples:\n"
      "  bess-train impact --out impact\n"
      "  bess-train impact --fleet-mw 100 400 --policy sdp rbc-tuned --seeds 10 --out mixed");
  command.runs([options] { run_impact(*options); });
}

}  // namespace bess
