// bess-train delays: what it costs to see prices late, and what it costs to have been fitted for
// another delay than the one that is met. For each policy a square table: fitted at delay 0..3
// (rows) and run at delay 0..3 (columns). With --ramps, what it costs that the battery follows
// slowly as well: each ramp (rows) at each delay of 0..6 (columns), fitted for that delay.
#include <fmt/core.h>

#include <array>
#include <cmath>
#include <memory>

#include "shared/host/distinct_files.h"
#include "shared/host/file.h"
#include "shared/host/html_text.h"
#include "shared/host/json.h"
#include "shared/host/user_error.h"
#include "workstation/base/answer.h"
#include "workstation/chain/common_options.h"
#include "workstation/chain/policy_factory.h"
#include "workstation/chain/price_input.h"
#include "workstation/cli/commands.h"
#include "workstation/env/evaluate.h"
#include "workstation/report/comparison.h"
#include "workstation/report/figures/heat_map.h"
#include "workstation/report/report_page.h"

namespace bess {
namespace {

constexpr int kDelays = 4;        // 0 to 3 minutes
constexpr int kDelaysByRamp = 7;  // 0 to 6

struct DelaysArguments {
  CommonOptions common;
  PriceInput price_input;
  std::string prices;
  std::vector<std::string> policies = baseline_names(kUnlessToldOther);
  std::string split = "test";
  bool carry_soc = false;
  bool json = false;
  std::vector<double> ramps_percent_per_min;  ///< of the rated power; empty: none
  std::string html;
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

Cell cell_of(Policy& policy, const MarketSteps& market, const RunConfig& config,
             const DelaysArguments& options) {
  const auto days = market.days_of(parse_split(options.split));
  if (days.empty()) {
    fail("{}: no complete day in the {} split; add prices or use --split all", options.prices,
         options.split);
  }
  const Evaluation result =
      evaluate(market, days, policy, {config.battery, config.initial_soc_frac, options.carry_soc});
  return {result.days.size(), result.profit_eur_per_day_per_mwh(), result.errors(),
          result.profit_at_wear_eur_per_day_per_mwh(kReferenceWearEurPerMwh)};
}

Table delay_table(const std::string& name, const Markets& markets, const RunConfig& config,
                  const DelaysArguments& options) {
  Table table{};
  for (int fit = 0; fit < kDelays; ++fit) {
    const std::shared_ptr<Policy> policy = make_policy(name, markets[fit], config.battery);
    for (int run = 0; run < kDelays; ++run) {
      table[fit][run] = cell_of(*policy, markets[run], config, options);
    }
  }
  return table;
}

/// [ramp][delay], fitted for the delay that it is run at.
std::vector<std::vector<Cell>> ramp_table(const std::string& name, const Markets& markets,
                                          RunConfig config, const DelaysArguments& options) {
  std::vector<std::vector<Cell>> table(options.ramps_percent_per_min.size());
  for (const MarketSteps& market : markets) {
    const std::shared_ptr<Policy> policy = make_policy(name, market, config.battery);
    for (std::size_t r = 0; r < table.size(); ++r) {
      config.battery.response.ramp_w_per_s =
          options.ramps_percent_per_min[r] / 100 * config.battery.power_w_max / 60;
      table[r].push_back(cell_of(*policy, market, config, options));
    }
  }
  return table;
}

void print_ramp_table(const std::string& name, const std::vector<std::vector<Cell>>& table,
                      const DelaysArguments& options) {
  fmt::print("{}, fitted for its delay\n{:>16}", name, "delay");
  for (int delay = 0; delay < kDelaysByRamp; ++delay) fmt::print("{:9}", delay);
  fmt::print("\n");
  for (std::size_t r = 0; r < table.size(); ++r) {
    const double ramp = options.ramps_percent_per_min[r];
    fmt::print("{:>16}", ramp == 0 ? "at once" : fmt::format("{:g} %/min", ramp));
    for (const Cell& cell : table[r]) fmt::print("{:9.1f}", cell.profit);
    fmt::print("\n");
  }
}

std::vector<HeatPoint> map_of(const std::vector<std::vector<Cell>>& table,
                              const DelaysArguments& options) {
  std::vector<HeatPoint> points;
  for (std::size_t r = 0; r < table.size(); ++r) {
    for (std::size_t delay = 0; delay < table[r].size(); ++delay) {
      points.push_back({std::to_string(delay),
                        fmt::format("{:g}", options.ramps_percent_per_min[r]),
                        table[r][delay].profit});
    }
  }
  return points;
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

/// NaN, null there: of no table over ramps.
void print_answer(const std::string& name, const Cell& cell, int fit_delay_min, int run_delay_min,
                  double ramp_percent_per_min, const DelaysArguments& options) {
  Json json = answer("delay");
  json.set("policy", name);
  json.set("split", options.split);
  json.set(key::kCarrySoc, options.carry_soc);
  json.set("fit_delay_min", fit_delay_min);
  json.set("run_delay_min", run_delay_min);
  json.set("ramp_percent_per_min", Decimals{ramp_percent_per_min, 3});
  json.set("days", cell.days);
  json.set(key::kProfit, Decimals{cell.profit, 4});
  json.set(kReferenceWearKey, Decimals{cell.profit_at_reference_wear, 4});
  json.set(key::kProfitError, Decimals{cell.errors.plain, 4});
  json.set(key::kProfitErrorByMonth, Decimals{cell.errors.by_month, 4});
  fmt::print("{}\n", json.line());
}

void tell_of_delays(const Markets& markets, const RunConfig& config,
                    const DelaysArguments& options) {
  for (const std::string& name : options.policies) {
    const Table table = delay_table(name, markets, config, options);
    if (!options.json) print_table(name, table);
    if (!options.json) continue;
    for (int fit = 0; fit < kDelays; ++fit) {
      for (int run = 0; run < kDelays; ++run) {
        print_answer(name, table[fit][run], fit, run, std::nan(""), options);
      }
    }
  }
  if (!options.json) {
    fmt::print("\nat wear {:g}: {}\n", kReferenceWearEurPerMwh,
               reference_wear_meaning(config.battery.wear_eur_per_mwh));
  }
}

void tell_of_ramps(const Markets& markets, const RunConfig& config,
                   const DelaysArguments& options) {
  std::string maps;
  for (const std::string& name : options.policies) {
    const auto table = ramp_table(name, markets, config, options);
    maps += heat_map_html(map_of(table, options),
                          {"delay, minutes", "ramp, % a minute", name + ", EUR per day per MWh",
                           fmt::format("map-{}", name)});
    if (!options.json) print_ramp_table(name, table, options);
    if (!options.json) continue;
    for (std::size_t r = 0; r < table.size(); ++r) {
      for (int delay = 0; delay < kDelaysByRamp; ++delay) {
        print_answer(name, table[r][static_cast<std::size_t>(delay)], delay, delay,
                     options.ramps_percent_per_min[r], options);
      }
    }
  }
  if (options.html.empty()) return;
  const std::string body = fmt::format(
      "<h1>What delay and ramp cost</h1>\n<p class=\"note\">{} split of {}. A policy is fitted for "
      "each delay, as if the battery followed at once.</p>\n{}",
      options.split, html_escaped(options.prices), maps);
  write_file(options.html, format_chart_page("What delay and ramp cost", body, Json::list()));
}

void run_delays(const DelaysArguments& options) {
  RunConfig config = options.common.resolve();
  require_policies(options.policies);
  if (!options.html.empty()) {
    require_distinct({{"--html", options.html}}, {{"--prices", options.prices}});
    require_writable(options.html);
  }
  const MinuteSeries series = options.price_input.read(options.prices);
  const bool by_ramp = !options.ramps_percent_per_min.empty();
  Markets markets;
  for (int delay = 0; delay < (by_ramp ? kDelaysByRamp : kDelays); ++delay) {
    config.market.observation_delay_min = delay;
    markets.push_back(market_of(series, config.market, options.prices));
  }
  if (!options.json) {
    fmt::print("{} split, EUR per day per MWh of capacity, {}; delays in minutes\n", options.split,
               options.carry_soc ? "SoC carried over" : "each day starts at the same SoC");
  }
  by_ramp ? tell_of_ramps(markets, config, options) : tell_of_delays(markets, config, options);
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
  command
      .option(
          "--ramps", options->ramps_percent_per_min,
          "Ramps of the battery, in % of its power a minute, 0 = at once: a table over them and "
          "delays of 0 to 6 minutes")
      .range(0.0, 1e6);
  command.option("--html", options->html, "That table as a heat map").needs("--ramps");
  command.flag("--json", options->json, "One JSON object a line, policy and cell");
  command.footer(
      "Examples:\n"
      "  bess-train delays --prices market.csv.gz\n"
      "  bess-train delays --prices market.csv.gz --policy sdp --ramps 0 20 50 --html delays.html\n"
      "  bess-train delays --prices market.csv.gz --policy rbc mpc student.json --carry-soc "
      "--json");
  command.runs([options] { run_delays(*options); });
}

}  // namespace bess
