// bess-train impact: what a fleet that moves its own price earns, as it grows.
#include <fmt/core.h>

#include <algorithm>
#include <charconv>
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
  std::vector<double> fleets;
  for (const std::string& text : texts) {
    double mw = -1;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), mw);
    const bool is_whole = read.ec == std::errc() && read.ptr == text.data() + text.size();
    if (!is_whole || !(mw >= 0 && mw <= kFleetMwMax)) {
      fail("--fleet-mw {}: use megawatts from 0, a fleet that moves nothing, to {:g}", text,
           kFleetMwMax);
    }
    fleets.push_back(mw);
  }
  std::ranges::sort(fleets);
  fleets.erase(std::unique(fleets.begin(), fleets.end()), fleets.end());
  return fleets;
}

void run_impact(const ImpactArguments& options) {
  const fs::path folder = options.out;
  require_distinct({{"--out", folder / "impact.csv"}, {"--out", folder / "impact.html"}},
                   {{"--config", options.common.config_path}});
  const RunConfig config = options.common.resolve();
  ImpactPlan plan = options.plan;
  if (!options.fleet_mw.empty()) plan.fleet_mw = fleets_of(options.fleet_mw);
  plan.threads = config.train.threads;
  require_policies(plan.policies);
  for (const std::string& policy : plan.policies) {
    if (policy == kForesightName || policy == kOutlookProgramName) {
      fail("--policy {}: the simulated fleet has neither tomorrow's prices nor the day-ahead ones",
           policy);
    }
  }
  if (config.market.observation_delay_min == 0) {
    fail("[market] observation_delay_min = 0: a fleet cannot see what it has not done yet; use 1");
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
      "impact", "A fleet that moves its own price: EUR a MW over its size, by price formula");
  command.option("--out", options->out, "Folder for table and page").required();
  command.option("--fleet-mw", options->fleet_mw,
                 "Sizes; 0 moves nothing (default 0 50 100 200 300 450 600 800 1200)");
  command
      .option("--policy", plan.policies,
              std::string("Of the fleet, each an equal part of it: ") + policy_help())
      .with_default();
  command.option("--train-days", plan.train_days, "That policies are fitted on")
      .range(10, 300)
      .with_default();
  command.option("--test-days", plan.test_days, "Behind them, that are traded")
      .range(1, 300)
      .with_default();
  command.option("--seeds", plan.seeds, "Simulated markets, seeds 1 to this")
      .range(1, 1000)
      .with_default();
  command.option("--rounds", plan.rounds, "Times that it is learnt anew on prices it made itself")
      .range(0, 20)
      .with_default();
  command.flag("--json", options->json, "One JSON object");
  command.option("--threads", options->common.threads, "Default: all cores").range(1, 256);
  command.option("--delay", options->common.delay_min, "Observation delay in minutes (default 1)")
      .range(1, 5);
  options->common.add_config(command);
  command.footer(
      "Examples:\n"
      "  bess-train impact --out impact\n"
      "  bess-train impact --fleet-mw 100 400 --policy sdp rbc-tuned --seeds 10 --out mixed");
  command.runs([options] { run_impact(*options); });
}

}  // namespace bess
