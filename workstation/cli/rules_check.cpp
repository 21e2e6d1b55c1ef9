// bess-train rules check: conflicts and scope of rules; with a policy, its violations on real days.
#include <fmt/core.h>

#include <memory>

#include "shared/host/json.h"
#include "shared/host/user_error.h"
#include "workstation/base/answer.h"
#include "workstation/cli/commands.h"
#include "workstation/correction/rules/properties.h"
#include "workstation/correction/rules/rule_conflicts.h"
#include "workstation/correction/rules/ruled_policy.h"
#include "workstation/data/env/context_fit.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/policy/rl/teacher.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/policy_factory.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/chain/rule_files.h"

namespace bess {
namespace {

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
  const auto whole = [](std::optional<std::int64_t> number) {
    return number ? Json(*number) : Json::null();
  };
  const auto counted = [&](std::int64_t WatchCount::*field) {
    return count ? Json((*count).*field) : Json::null();
  };
  Json json = answer("rule");
  json.set("rule", rule.name);
  json.set("rule_text", rule.text());
  json.set("context", context_name(kind));
  json.set("binds_student", binds_student(rule, kind));
  json.set("enforced", rule.enforce);
  json.set("policy", text_or_null(policy));
  json.set("split", text_or_null(split));
  json.set("decisions", whole(decisions));
  json.set("visited", counted(&WatchCount::visited));
  json.set("visited_broken", counted(&WatchCount::visited_broken));
  json.set("drawn", counted(&WatchCount::drawn));
  json.set("drawn_broken", counted(&WatchCount::drawn_broken));
  return json;
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

}  // namespace

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

}  // namespace bess
