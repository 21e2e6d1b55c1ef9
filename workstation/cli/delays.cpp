// bess-train delays: what it costs to see prices late, and what it costs to have been fitted for
// another delay than the one that is met. For each policy a square table: fitted at delay 0..3
// (rows) and run at delay 0..3 (columns).
#include <fmt/core.h>

#include <array>
#include <memory>

#include "shared/host/json.h"
#include "shared/host/user_error.h"
#include "workstation/base/answer.h"
#include "workstation/chain/common_options.h"
#include "workstation/chain/policy_factory.h"
#include "workstation/chain/price_input.h"
#include "workstation/cli/commands.h"
#include "workstation/env/evaluate.h"
#include "workstation/report/comparison.h"

namespace bess {
namespace {

constexpr int kDelays = 4;  // 0 to 3 minutes

struct DelaysArguments {
  CommonOptions common;
  PriceInput price_input;
  std::string prices;
  std::vector<std::string> policies = baseline_names(kUnlessToldOther);
  std::string split = "test";
  bool carry_soc = false;
  bool json = false;
};

/// EUR per day per MWh
struct Cell {
  std::size_t days;
  double profit;
  DayErrors errors;
  double profit_at_reference_wear;  ///< of the same decisions
};
/// [fitted at][run at]
using Table = std::array<std::array<Cell, kDelays>, kDelays>;
using Markets = std::vector<MarketSteps>;

Table delay_table(const std::string& name, const Markets& markets, const RunConfig& config,
                  const DelaysArguments& options) {
  Table table{};
  for (int fit = 0; fit < kDelays; ++fit) {
    const std::shared_ptr<Policy> policy = make_policy(name, markets[fit], config.battery);
    for (int run = 0; run < kDelays; ++run) {
      const auto days = markets[run].days_of(parse_split(options.split));
      if (days.empty()) {
        fail("{}: no complete day in the {} split; add prices or use --split all", options.prices,
             options.split);
      }
      const Evaluation result =
          evaluate(markets[run], days, *policy,
                   {config.battery, config.initial_soc_frac, options.carry_soc});
      table[fit][run] = {result.days.size(), result.profit_eur_per_day_per_mwh(), result.errors(),
                         result.profit_at_wear_eur_per_day_per_mwh(kReferenceWearEurPerMwh)};
    }
  }
  return table;
}

void print_table(const std::string& name, const Table& table) {
  fmt::print("{}\n{:>52}{:>4}{:>36}\n", name, "profit", "",
             fmt::format("at wear {:g}", kReferenceWearEurPerMwh));
  fmt::print("{:>16}{:>9}{:>9}{:>9}{:>9}{:>4}{:>9}{:>9}{:>9}{:>9}\n", "run at delay", 0, 1, 2, 3,
             "", 0, 1, 2, 3);
  for (int fit = 0; fit < kDelays; ++fit) {
    fmt::print("{:>14} {}", fit == 0 ? "fitted at" : "", fit);
    for (const Cell& cell : table[fit]) fmt::print("{:9.1f}", cell.profit);
    fmt::print("{:>4}", "");
    for (const Cell& cell : table[fit]) fmt::print("{:9.1f}", cell.profit_at_reference_wear);
    fmt::print("\n");
  }
}

void print_json(const std::string& name, const Table& table, const DelaysArguments& options) {
  for (int fit = 0; fit < kDelays; ++fit) {
    for (int run = 0; run < kDelays; ++run) {
      const Cell& cell = table[fit][run];
      Json json = answer("delay");
      json.set("policy", name);
      json.set("split", options.split);
      json.set(key::kCarrySoc, options.carry_soc);
      json.set("fit_delay_min", fit);
      json.set("run_delay_min", run);
      json.set("days", cell.days);
      json.set(key::kProfit, Decimals{cell.profit, 4});
      json.set(kReferenceWearKey, Decimals{cell.profit_at_reference_wear, 4});
      json.set(key::kProfitError, Decimals{cell.errors.plain, 4});
      json.set(key::kProfitErrorByMonth, Decimals{cell.errors.by_month, 4});
      fmt::print("{}\n", json.line());
    }
  }
}

void run_delays(const DelaysArguments& options) {
  RunConfig config = options.common.resolve();
  require_policies(options.policies);
  const MinuteSeries series = options.price_input.read(options.prices);
  Markets markets;
  for (int delay = 0; delay < kDelays; ++delay) {
    config.market.observation_delay_min = delay;
    markets.push_back(market_of(series, config.market, options.prices));
  }
  if (!options.json) {
    fmt::print("{} split, EUR per day per MWh of capacity, {}; delays in minutes\n", options.split,
               options.carry_soc ? "SoC carried over" : "each day starts at the same SoC");
  }
  for (const std::string& name : options.policies) {
    const Table table = delay_table(name, markets, config, options);
    options.json ? print_json(name, table, options) : print_table(name, table);
  }
  if (!options.json) {
    fmt::print("\nat wear {:g}: {}\n", kReferenceWearEurPerMwh,
               reference_wear_meaning(config.battery.wear_eur_per_mwh));
  }
}

}  // namespace

void add_delays_command(ProgramCommand& app) {
  auto options = std::make_shared<DelaysArguments>();
  ProgramCommand command =
      app.subcommand("delays", "The cost of seeing prices late: fitted at 0-3 min, run at 0-3");
  command.option("--prices", options->prices, "Minute file (.csv or .csv.gz)").required();
  options->price_input.add(command);
  command.option("--policy", options->policies, std::string("One or more of ") + policy_help())
      .with_default();
  command
      .option("--split", options->split,
              "Local days 1-20, 21-25, 26-end, the last two together, or all")
      .one_of({kSplitNames.begin(), kSplitNames.end()})
      .with_default();
  options->common.add_config(command);
  command.flag("--carry-soc", options->carry_soc, "Chain the days instead of resetting SoC");
  command.flag("--json", options->json, "One JSON object a line, policy and pair of delays");
  command.footer(
      "Examples:\n"
      "  bess-train delays --prices market.csv.gz\n"
      "  bess-train delays --prices market.csv.gz --policy rbc mpc student.json --carry-soc "
      "--json");
  command.runs([options] { run_delays(*options); });
}

}  // namespace bess
