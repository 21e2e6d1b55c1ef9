// bess-train evaluate: what a policy would have earned.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "workstation/cli/commands.h"
#include "workstation/cli/common_options.h"
#include "workstation/cli/policy_factory.h"
#include "workstation/env/evaluate.h"
#include "workstation/env/foresight.h"
#include "workstation/io/file.h"
#include "workstation/io/user_error.h"

namespace bess {
namespace {

struct Options {
  CommonOptions common;
  std::string prices;
  std::vector<std::string> policies;
  std::string split = "test";
  std::string date;
  bool carry_soc = false;
  bool json = false;
  std::string days_out;
  std::string steps_out;
};

std::string evaluation_json(const std::string& policy, const Options& options, const Evaluation& e,
                            double foresight_profit) {
  const double profit = e.profit_eur_per_day_per_mwh();
  return fmt::format(
      R"({{"policy": {}, "split": "{}", "days": {}, "profit_eur_per_day_per_mwh": {:.4f}, )"
      R"("standard_error": {:.4f}, "cycles_per_day": {:.4f}, "worst_day_eur_per_mwh": {:.4f}, )"
      R"("share_of_foresight": {:.5f}, "switches_per_day": {:.3f}, "soc_end_mean": {:.5f}, )"
      R"("carry_soc": {}}})",
      json_quote(policy), options.split, e.days.size(), profit, e.standard_error(),
      e.cycles_per_day(), e.worst_day_eur_per_mwh(), profit / foresight_profit,
      e.switches_per_day(), e.soc_end_mean(), options.carry_soc);
}

void write_days(const std::string& path, const Evaluation& e) {
  std::string text = "date,profit_eur,cycles,switches,soc_end\n";
  for (const DayResult& d : e.days) {
    text += fmt::format("{},{:.4f},{:.4f},{},{:.5f}\n", d.date, d.profit_eur, d.cycles, d.switches,
                        d.soc_end_frac);
  }
  write_file(path, text);
}

void write_steps(const std::string& path, const std::vector<StepRecord>& records) {
  std::string text = "utc,observed_eur_mwh,paid_eur_mwh,soc,action,power_w,profit_eur\n";
  for (const StepRecord& r : records) {
    text += fmt::format("{},{:.2f},{:.2f},{:.6f},{},{:.3f},{:.6f}\n", format_utc(r.utc_s),
                        r.observed_eur_per_mwh, r.paid_eur_per_mwh, r.soc_frac,
                        action_name(r.action), r.power_w, r.profit_eur);
  }
  write_file(path, text);
}

void print_line(const std::string& policy, const Evaluation& e, double foresight_profit,
                const PairedDifference& difference) {
  fmt::print("{:24} {:9.1f} ±{:6.1f} {:+9.1f} ±{:6.1f} {:9.1f} {:7.2f} {:9.1f} {:7.1f} %\n", policy,
             e.profit_eur_per_day_per_mwh(), e.standard_error(), difference.mean,
             difference.standard_error, e.worst_day_eur_per_mwh(), e.cycles_per_day(),
             e.switches_per_day(), 100 * e.profit_eur_per_day_per_mwh() / foresight_profit);
}

double price_range(const MarketSteps& market, const MarketDay& day) {
  const auto [low, high] =
      std::ranges::minmax(market.of(day), {}, &MarketStep::observed_eur_per_mwh);
  return high.observed_eur_per_mwh - low.observed_eur_per_mwh;
}

/// The one day that --date names, out of those of the split.
MarketDay select_day(const MarketSteps& market, const std::vector<MarketDay>& days,
                     const std::string& date) {
  const auto found =
      date == "widest"
          ? std::ranges::max_element(days, {},
                                     [&](const MarketDay& day) { return price_range(market, day); })
          : std::ranges::find_if(days, [&](const MarketDay& day) { return day.date() == date; });
  if (found == days.end()) {
    fail(
        "--date {}: no complete day of that date in the split; use YYYY-MM-DD or widest, and "
        "perhaps --split all",
        date);
  }
  return *found;
}

void run(const Options& options) {
  const RunConfig config = options.common.resolve();
  const MarketSteps market = make_market_steps(read_minute_file(options.prices), config.market);
  std::vector<MarketDay> days = market.days_of(parse_split(options.split));
  if (days.empty()) {
    fail("{}: no complete day in the {} split; add prices or use --split all", options.prices,
         options.split);
  }
  if (!options.date.empty()) days = {select_day(market, days, options.date)};
  const EvaluationOptions evaluation{config.battery, config.initial_soc_frac, options.carry_soc};
  ForesightPolicy foresight(config.battery);
  const double foresight_profit =
      evaluate(market, days, foresight, evaluation).profit_eur_per_day_per_mwh();
  std::vector<Evaluation> results;
  for (const std::string& name : options.policies) {
    const std::shared_ptr<Policy> policy = make_policy(name, market, config.battery);
    std::vector<StepRecord> records;
    results.push_back(evaluate(market, days, *policy, evaluation,
                               options.steps_out.empty() ? nullptr : &records));
    if (!options.steps_out.empty()) write_steps(options.steps_out, records);
    if (!options.days_out.empty()) write_days(options.days_out, results.back());
  }
  if (!options.json) {
    fmt::print("{} {} days, EUR/day/MWh{}\n", days.size(), options.split,
               options.carry_soc ? ", SoC carried over" : "");
    fmt::print("{:24} {:>17} {:>17} {:>9} {:>7} {:>9} {:>9}\n", "policy", "profit ± s.e.",
               "minus first", "worst day", "cycles", "switches", "foresight");
  }
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (options.json) {
      fmt::print("{}\n",
                 evaluation_json(options.policies[i], options, results[i], foresight_profit));
    } else {
      print_line(options.policies[i], results[i], foresight_profit,
                 paired_difference(results[i], results[0]));
    }
  }
}

}  // namespace

void add_evaluate_command(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("evaluate", "What a policy would have earned");
  command->add_option("--prices", options->prices, "Minute file (.csv or .csv.gz)")->required();
  command->add_option("--policy", options->policies, std::string("One or more of ") + kPolicyHelp)
      ->required();
  command->add_option("--split", options->split, "Local days 1-20, 21-25, 26-end, or all")
      ->check(CLI::IsMember({"train", "val", "test", "all"}))
      ->capture_default_str();
  command->add_option("--date", options->date,
                      "Only this day of the split: YYYY-MM-DD, or widest (largest price range)");
  options->common.add_market(*command);
  options->common.add_config(*command);
  command->add_flag("--carry-soc", options->carry_soc, "Chain the days instead of resetting SoC");
  command->add_flag("--json", options->json, "One JSON object a line and policy");
  command->add_option("--days-out", options->days_out, "CSV of the last policy's days");
  command->add_option("--steps-out", options->steps_out, "CSV of the last policy's steps");
  command->footer(
      "Examples:\n"
      "  bess-train evaluate --prices market.csv.gz --policy rbc tabular foresight\n"
      "  bess-train evaluate --prices market.csv.gz --policy runs/a/student.json --split all "
      "--carry-soc --json\n"
      "  bess-train evaluate --prices market.csv.gz --policy compiled --date widest --steps-out "
      "day.csv");
  command->callback([options] { run(*options); });
}

}  // namespace bess
