// bess-train rules: operator rules before training.
#include <fmt/core.h>

#include <cmath>
#include <memory>

#include "shared/host/json.h"
#include "shared/host/user_error.h"
#include "workstation/base/answer.h"
#include "workstation/cli/commands.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/correction/rules/rule_conflicts.h"
#include "workstation/correction/rules/ruled_policy.h"
#include "workstation/data/env/context_fit.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/policy_factory.h"
#include "workstation/runs/chain/price_input.h"

namespace bess {
namespace {

// bess-train rules check: conflicts and scope of rules; with a policy, its violations on real days.

/// Additional uniformly drawn SoCs checked at each decision.
constexpr int kDrawnPerStep = 4;

struct CheckArguments {
  CommonOptions common;
  RuleFiles rule_files;
  PriceInput price_input;
  std::string prices;
  std::string policy;
  std::string split = "val+test";
  std::optional<std::string> context;
  bool json = false;
};

/// Counts are null without a policy.
Json rule_json(const Rule& rule, ContextKind kind, const std::string& policy,
               const std::string& split, std::optional<std::int64_t> decisions,
               const std::optional<WatchCount>& count) {
  const auto counted = [&](std::int64_t WatchCount::*field) {
    return count ? Json((*count).*field) : Json::null();
  };
  return answer("rule", {{"rule", rule.name},
                         {"rule_text", rule.text()},
                         {"context", context_name(kind)},
                         {"binds_student", binds_student(rule, kind)},
                         {"enforced", rule.enforce},
                         {"policy", text_or_null(policy)},
                         {"split", text_or_null(split)},
                         {"decisions", decisions ? Json(*decisions) : Json::null()},
                         {"visited", counted(&WatchCount::visited)},
                         {"visited_broken", counted(&WatchCount::visited_broken)},
                         {"drawn", counted(&WatchCount::drawn)},
                         {"drawn_broken", counted(&WatchCount::drawn_broken)}});
}

void print_rules(const RuleSet& rules, ContextKind kind, bool json) {
  for (const Rule& rule : rules.rules) {
    if (json) {
      fmt::print("{}\n", rule_json(rule, kind, {}, {}, {}, {}).line());
    } else {
      fmt::print("{:<40}  {:<17}  {}\n", rule.name, held_by(rule, kind), rule.text());
    }
  }
}

double percent(std::int64_t part, std::int64_t whole) {
  return whole == 0 ? 0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

void print_watch(const RuleSet& rules, const RuleWatch& watch, ContextKind kind,
                 const CheckArguments& options) {
  if (!options.json) {
    fmt::print(
        "\nviolations by {}, in {} decisions of the {} split and at {} drawn SoCs each (seed {}):\n"
        "{:<40}  {:>10}  {:>8}  {:>10}  {:>8}\n",
        options.policy, watch.decisions(), options.split, kDrawnPerStep,
        options.common.seed.value_or(1), "rule", "visited", "%", "drawn", "%");
  }
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    const WatchCount& c = watch.counts()[r];
    if (options.json) {
      fmt::print("{}\n", rule_json(rules.rules[r], kind, options.policy, options.split,
                                   watch.decisions(), c)
                             .line());
    } else if (c.visited + c.drawn == 0) {
      fmt::print("{:<40}  does not apply in these states\n", rules.rules[r].name);
    } else {
      fmt::print("{:<40}  {:>10}  {:>8.3f}  {:>10}  {:>8.3f}\n", rules.rules[r].name,
                 c.visited_broken, percent(c.visited_broken, watch.decisions()), c.drawn_broken,
                 percent(c.drawn_broken, watch.decisions() * kDrawnPerStep));
    }
  }
}

void run_rules_check(const CheckArguments& options) {
  const RunConfig config = options.common.resolve();
  const RuleSet rules = options.rule_files.read();
  ContextKind kind = config.train.context;
  if (options.context) kind = parse_context(*options.context);
  if (options.policy.empty()) {
    require_consistent(rules, config.distil.correction.thresholds, kind);
    return print_rules(rules, kind, options.json);
  }
  const MarketSteps market =
      market_of(options.price_input.read(options.prices), config.market, options.prices);
  const ContextClasses classes = context_of_policy(options.policy, market, kind);
  require_consistent(rules, config.distil.correction.thresholds, classes.kind);
  if (!options.json) print_rules(rules, classes.kind, false);
  const std::vector<MarketDay> days = market.days_of(parse_split(options.split));
  if (days.empty()) fail("{}: no complete day in the {} split", options.prices, options.split);
  const RuleSet all = with_properties(rules, config.distil.correction.thresholds);
  RuleWatch watch(make_policy(options.policy, market, config.battery), all, classes, kDrawnPerStep,
                  config.train.seed);
  evaluate(market, days, watch, {config.battery, config.initial_soc_frac, true});
  print_watch(all, watch, classes.kind, options);
}

void add_rules_check(ProgramCommand& rules) {
  auto options = std::make_shared<CheckArguments>();
  ProgramCommand command =
      rules.subcommand("check", "check rules for conflicts and scope (exit code 1 on conflict)");
  options->rule_files.add(command, "rule files (TOML)").required();
  command
      .option("--context", options->context,
              "context class: level or month (default: from the configuration)")
      .one_of({"level", "month"});
  command.option("--policy", options->policy,
                 std::string("count violations by this policy on real days: ") + policy_help());
  command.option("--prices", options->prices, "minute file, for --policy");
  options->price_input.add(command);
  command.option("--split", options->split, "days of --prices")
      .one_of({kSplitNames.begin(), kSplitNames.end()})
      .with_default();
  command.flag("--json", options->json, "JSON, one line per rule");
  options->common.add_all(command);
  command.footer(
      "Examples:\n"
      "  bess-train rules check --rules my_rules.toml\n"
      "  bess-train rules check --rules my_rules.toml --policy teacher.bin --prices market.csv.gz");
  command.runs([options] {
    if (!options->policy.empty() && options->prices.empty()) {
      fail("--policy needs --prices FILE");
    }
    run_rules_check(*options);
  });
}

// bess-train rules price: daily cost of each rule, alone and together, by projection of a policy's
// decisions.

struct PriceArguments {
  CommonOptions common;
  RuleFiles rule_files;
  PriceInput price_input;
  std::string prices;
  std::string policy = "compiled";
  std::string split = "val+test";
  bool json = false;
};

/// Day-reset and carried-over evaluation of the same days.
struct ResetAndCarried {
  Evaluation reset, carried;
};

/// Effect of rules in one accounting; NaN for a rule that cannot be projected.
struct RuleGain {
  double profit = NAN, profit_without = NAN;
  PairedDifference gain{NAN};

  RuleGain() = default;
  RuleGain(const Evaluation& with, const Evaluation& without)
      : profit(with.profit_eur_per_day_per_mwh()),
        profit_without(without.profit_eur_per_day_per_mwh()),
        gain(paired_difference(with, without)) {}

  void add_to(Json& json, bool carry_soc) const {
    json.set(key::kCarrySoc, carry_soc);
    json.set(key::kProfit, Decimals{profit, 4});
    json.set("profit_without_rules_eur_per_day_per_mwh", Decimals{profit_without, 4});
    json.set(key::kGain, Decimals{gain.mean, 4});
    json.set(key::kGainError, Decimals{gain.errors.plain, 4});
    json.set(key::kGainErrorByMonth, Decimals{gain.errors.by_month, 4});
  }
};

struct Pricing {
  const PriceArguments& options;
  const RunConfig& config;
  const MarketSteps& market;
  std::vector<MarketDay> days;

  ResetAndCarried run(Policy& policy) const {
    return {evaluate(market, days, policy, {config.battery, config.initial_soc_frac, false}),
            evaluate_carried_over(market, days, policy, config.battery, config.initial_soc_frac)};
  }

  void print_head(const ResetAndCarried& base, const std::string& name) const {
    if (options.json) return;
    fmt::print(
        "{} split, {} days; {} earns {:.1f} EUR per day per MWh of capacity, with the SoC carried "
        "over {:.1f}.\nChange by each rule, EUR per day per MWh:\n"
        "{:<40}  {:>7} {:>6} {:>8}  {:>7} {:>6} {:>8}  {:>12}\n",
        options.split, days.size(), name, base.reset.profit_eur_per_day_per_mwh(),
        base.carried.profit_eur_per_day_per_mwh(), "rule", "reset", "s.e.", "by month", "carried",
        "s.e.", "by month", "decisions, %");
  }

  void print_row(const std::string& rule, const ResetAndCarried& base, const ResetAndCarried& ruled,
                 double changed_share) const {
    const RuleGain reset(ruled.reset, base.reset), carried(ruled.carried, base.carried);
    if (options.json) return print_json(rule, reset, carried, changed_share);
    fmt::print("{:<40}  {:>+7.2f} {:>6} {:>8}  {:>+7.2f} {:>6} {:>8}  {:>12.2f}\n", rule,
               reset.gain.mean, error_text(reset.gain.errors.plain, 2),
               error_text(reset.gain.errors.by_month, 2), carried.gain.mean,
               error_text(carried.gain.errors.plain, 2),
               error_text(carried.gain.errors.by_month, 2), 100 * changed_share);
  }

  /// For a rule that does not restrict single decisions.
  void print_unknown(const std::string& rule) const {
    if (options.json) return print_json(rule, {}, {}, NAN);
    fmt::print("{:<40}  not on single states: see 'distil --rules'\n", rule);
  }

  void print_json(const std::string& rule, const RuleGain& reset, const RuleGain& carried_over,
                  double changed_share) const {
    Json json = answer("rule_price", {{"rule", rule},
                                      {key::kGainOver, options.policy},
                                      {"split", options.split},
                                      {"days", days.size()},
                                      {"share_of_decisions_changed", Decimals{changed_share, 6}}});
    reset.add_to(json, false);
    Json carried = Json::object();
    carried_over.add_to(carried, true);
    json.set(key::kCarriedOver, std::move(carried));
    fmt::print("{}\n", json.line());
  }
};

void run_rules_price(const PriceArguments& options) {
  const RunConfig config = options.common.resolve();
  const RuleSet rules = options.rule_files.read();
  const MarketSteps market =
      market_of(options.price_input.read(options.prices), config.market, options.prices);
  const Pricing pricing{options, config, market, market.days_of(parse_split(options.split))};
  if (pricing.days.empty())
    fail("{}: no complete day in the {} split", options.prices, options.split);
  const ContextClasses classes = context_of_policy(options.policy, market, config.train.context);
  require_consistent(rules, config.distil.correction.thresholds, classes.kind);
  const std::shared_ptr<Policy> policy = make_policy(options.policy, market, config.battery);
  if (policy->sees_future()) {
    fail(
        "--policy {}: it plans with future prices and ignores the rules; choose a policy that does "
        "not see the future",
        options.policy);
  }
  const ResetAndCarried base = pricing.run(*policy);
  pricing.print_head(base, options.policy);
  const auto price = [&](const std::string& name, const RuleSet& some) {
    RuledPolicy ruled(policy, some, classes);
    const ResetAndCarried evaluated = pricing.run(ruled);
    pricing.print_row(name, base, evaluated, ruled.changed_share());
  };
  for (const Rule& rule : rules.rules) {
    if (can_be_projected(rule)) {
      price(rule.name, {{rule}});
    } else {
      pricing.print_unknown(rule.name);
    }
  }
  if (rules.rules.size() > 1) price("all together", rules);
}

void add_rules_price(ProgramCommand& rules) {
  auto options = std::make_shared<PriceArguments>();
  ProgramCommand command = rules.subcommand(
      "price", "estimate the daily cost of each rule, alone and together, before training");
  options->rule_files.add(command, "rule files (TOML)").required();
  command.option("--prices", options->prices, "minute file (.csv or .csv.gz)").required();
  options->price_input.add(command);
  command
      .option("--policy", options->policy,
              std::string("policy to which the rules are applied; one of ") + policy_help())
      .with_default();
  command.option("--split", options->split, "traded days of --prices")
      .one_of({kSplitNames.begin(), kSplitNames.end()})
      .with_default();
  command.flag("--json", options->json, "JSON, one line per rule");
  options->common.add_all(command);
  command.footer(
      "Examples:\n"
      "  bess-train rules price --rules my_rules.toml --prices market.csv.gz\n"
      "  bess-train rules price --rules a.toml b.toml --prices market.csv.gz --policy teacher.bin");
  command.runs([options] { run_rules_price(*options); });
}

}  // namespace

void add_rules_commands(ProgramCommand& app) {
  ProgramCommand rules = app.subcommand("rules", "operator rules: check, price");
  rules.requires_subcommand();
  add_rules_check(rules);
  add_rules_price(rules);
}

}  // namespace bess
