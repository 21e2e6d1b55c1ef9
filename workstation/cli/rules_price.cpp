// bess-train rules price: what each rule costs or earns a day, alone and all together. First by
// projecting a policy's decisions, in seconds; then, if a teacher is given, by distilling a student
// with them and one without.
#include <fmt/core.h>

#include <cstdio>
#include <memory>

#include "shared/host/user_error.h"
#include "workstation/chain/common_options.h"
#include "workstation/chain/distilled_prices.h"
#include "workstation/chain/policy_factory.h"
#include "workstation/chain/price_input.h"
#include "workstation/chain/rule_files.h"
#include "workstation/chain/rule_price_json.h"
#include "workstation/cli/commands.h"
#include "workstation/env/evaluate.h"
#include "workstation/rules/rule_conflicts.h"
#include "workstation/rules/ruled_policy.h"

namespace bess {
namespace {

struct PriceArguments {
  CommonOptions common;
  RuleFiles rule_files;
  PriceInput price_input;
  std::string prices;
  std::string policy = "compiled";
  std::string teacher;
  std::string keep;
  std::string split = "val+test";
  int seeds = 1;
  bool alone = false;
  bool json = false;
};

class Pricing {
 public:
  Pricing(const PriceArguments& options, const RunConfig& config, const MarketSteps& market)
      : options_(options), config_(config), market_(market) {
    days_ = market.days_of(parse_split(options.split));
    if (days_.empty()) fail("{}: no complete day in the {} split", options.prices, options.split);
  }

  BothWays run(Policy& policy) const { return run_both_ways(policy, days_, config_, market_); }
  [[nodiscard]] const std::vector<MarketDay>& days() const { return days_; }

  void print_head(const BothWays& base, const std::string& name) const {
    if (options_.json) return;
    fmt::print(
        "{} split, {} days; {} earns {:.1f} EUR a day per MWh of capacity, with the SoC carried "
        "over {:.1f}.\nWhat rules change of it, day by day:\n"
        "{:<40}  {:>7} {:>6} {:>8}  {:>7} {:>6} {:>8}  {:>12}\n",
        options_.split, days_.size(), name, base.reset.profit_eur_per_day_per_mwh(),
        base.carried.profit_eur_per_day_per_mwh(), "rule", "reset", "s.e.", "by month", "carried",
        "s.e.", "by month", "decisions, %");
  }

  void print_row(const std::string& rule, const BothWays& base, const BothWays& ruled,
                 double changed_share) const {
    const PairedDifference reset = paired_difference(ruled.reset, base.reset);
    const PairedDifference carried = paired_difference(ruled.carried, base.carried);
    if (!options_.json) {
      fmt::print("{:<40}  {:>+7.2f} {:>6} {:>8}  {:>+7.2f} {:>6} {:>8}  {:>12.2f}\n", rule,
                 reset.mean, error_text(reset.standard_error, 2),
                 error_text(reset.standard_error_by_month, 2), carried.mean,
                 error_text(carried.standard_error, 2),
                 error_text(carried.standard_error_by_month, 2), 100 * changed_share);
      return;
    }
    const auto gain = [](const Evaluation& with, const Evaluation& without,
                         const PairedDifference& difference) {
      return RuleGain{with.profit_eur_per_day_per_mwh(), without.profit_eur_per_day_per_mwh(),
                      difference.mean, difference.standard_error,
                      difference.standard_error_by_month};
    };
    RulePriceRow row = row_of(rule);
    row.reset = gain(ruled.reset, base.reset, reset);
    row.carried = gain(ruled.carried, base.carried, carried);
    row.changed_share = changed_share;
    fmt::print("{}\n", rule_price_json(row).line());
  }

  /// Of a rule that no single decision can be moved by.
  void print_unknown(const std::string& rule) const {
    if (options_.json) {
      fmt::print("{}\n", rule_price_json(row_of(rule)).line());
    } else {
      fmt::print("{:<40}  no demand on single states: give --teacher to see\n", rule);
    }
  }

 private:
  [[nodiscard]] RulePriceRow row_of(const std::string& rule) const {
    return {.rule = rule,
            .by = "projection",
            .gain_over = options_.policy,
            .split = options_.split,
            .days = days_.size(),
            .reset = {},
            .carried = {}};
  }

  const PriceArguments& options_;
  const RunConfig& config_;
  const MarketSteps& market_;
  std::vector<MarketDay> days_;
};

void price_by_projection(const PriceArguments& options, const RunConfig& config,
                         const MarketSteps& market, const RuleSet& rules, const Pricing& pricing) {
  const ContextClasses classes = context_of_policy(options.policy, market, config.train.context);
  require_consistent(rules, config.distil.correction.thresholds, classes.kind);
  const std::shared_ptr<Policy> policy = make_policy(options.policy, market, config.battery);
  if (policy->sees_future()) {
    fail(
        "--policy {}: it plans ahead without the rules; price them on a policy that does not see "
        "the future",
        options.policy);
  }
  const BothWays base = pricing.run(*policy);
  pricing.print_head(base, options.policy);
  const auto price = [&](const std::string& name, const RuleSet& some) {
    RuledPolicy ruled(policy, some, classes);
    const BothWays evaluated = pricing.run(ruled);
    pricing.print_row(name, base, evaluated, ruled.changed_share());
  };
  for (const Rule& rule : rules.rules) {
    if (can_be_projected(rule)) {
      price(rule.name, {{rule}});
    } else {
      pricing.print_unknown(rule.name);
    }
  }
  if (rules.rules.size() > 1) price(kAllTogether, rules);
}

void run_rules_price(const PriceArguments& options) {
  const RunConfig config = options.common.resolve();
  const RuleSet rules = options.rule_files.read();
  const MarketSteps market =
      market_of(options.price_input.read(options.prices), config.market, options.prices);
  const Pricing pricing(options, config, market);
  price_by_projection(options, config, market, rules, pricing);
  if (options.teacher.empty()) return;
  std::fflush(stdout);  // what follows takes minutes
  price_by_distilling({.rules = rules,
                       .days = pricing.days(),
                       .split = options.split,
                       .seeds = options.seeds,
                       .alone = options.alone,
                       .keep = options.keep,
                       .json = options.json},
                      load_teacher(options.teacher), config, market);
}

}  // namespace

void add_rules_price(ProgramCommand& rules) {
  auto options = std::make_shared<PriceArguments>();
  ProgramCommand command = rules.subcommand(
      "price", "What each rule costs or earns a day, alone and together, before it is trained");
  options->rule_files.add(command, "Rule files (TOML)").required();
  command.option("--prices", options->prices, "Minute file (.csv or .csv.gz)").required();
  options->price_input.add(command);
  command
      .option("--policy", options->policy,
              std::string("Whose decisions are projected; one of ") + policy_help())
      .with_default();
  command.option("--teacher", options->teacher,
                 "Also distil this teacher with all rules and without (minutes)");
  command
      .option("--seeds", options->seeds,
              "With --teacher: so many students of each kind, and how far they are apart")
      .range(1, 100)
      .with_default();
  command.flag("--alone", options->alone, "With --teacher: distil each rule alone as well");
  command.option("--keep", options->keep, "With --teacher: folder for the students");
  command.option("--split", options->split, "Days of --prices that are traded")
      .one_of({kSplitNames.begin(), kSplitNames.end()})
      .with_default();
  command.flag("--json", options->json, "One JSON object a line and rule");
  options->common.add_market(command);
  options->common.add_config(command);
  options->common.add_seed_and_threads(command);
  command.footer(
      "Examples:\n"
      "  bess-train rules price --rules my_rules.toml --prices market.csv.gz\n"
      "  bess-train rules price --rules my_rules.toml --prices market.csv.gz --policy teacher.bin "
      "--teacher teacher.bin\n"
      "  bess-train rules price --rules a.toml b.toml --prices market.csv.gz --policy teacher.bin "
      "--teacher teacher.bin --alone --seeds 3 --keep students");
  command.runs([options] {
    if (options->teacher.empty() &&
        (options->alone || options->seeds > 1 || !options->keep.empty())) {
      fail("--alone, --seeds and --keep are about distilling: add --teacher FILE");
    }
    run_rules_price(*options);
  });
}

}  // namespace bess
