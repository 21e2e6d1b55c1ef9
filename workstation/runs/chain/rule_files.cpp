#include "workstation/runs/chain/rule_files.h"

#include <fmt/format.h>

#include <memory>

#include "workstation/correction/rules/rule.h"
#include "workstation/correction/rules/rule_conflicts.h"
#include "workstation/correction/rules/ruled_policy.h"
#include "workstation/correction/student/prove.h"
#include "workstation/correction/student/student_policy.h"
#include "workstation/data/env/evaluate.h"

namespace bess {

std::string rule_count_lines(const Certificate& certificate) {
  std::string text;
  for (std::size_t r = 0; r < certificate.rule_counts().size(); ++r) {
    const Rule& rule = certificate.rules.rules[r];
    const RuleCount& count = certificate.rule_counts()[r];
    const std::string found =
        count.binds_student ? fmt::format("{} violations in {}", count.violations, count.states)
                            : "enforced by the guard only";
    text += fmt::format("  rule \"{}\", {}: {}\n", rule.name, rule.text(), found);
  }
  return text;
}

void add_certificate(const Certificate& certificate, Json& json) {
  json.set("states_checked", certificate.states_checked);
  json.set("states_evaluated", certificate.states_evaluated);
  json.set("low_price_eur_per_mwh", certificate.thresholds.low_eur_per_mwh);
  json.set("high_price_eur_per_mwh", certificate.thresholds.high_eur_per_mwh);
  json.set("violations", certificate.violations());
  add_property_violations(certificate, json);
  Json list = Json::list();
  for (std::size_t r = 0; r < certificate.rule_counts().size(); ++r) {
    const Rule& rule = certificate.rules.rules[r];
    const RuleCount& count = certificate.rule_counts()[r];
    list.add(Json::object({{"rule", rule.name},
                           {"binds_student", count.binds_student},
                           {"enforced", rule.enforce},
                           {"states", count.states},
                           {"violations", count.violations}}));
  }
  json.set("rules", std::move(list));
}

std::string broken_rule_lines(const StudentFile& student, const MarketSteps& market,
                              const RunConfig& config) {
  const Certificate& certificate = student.certificate;
  RuleSet broken;
  std::string text;
  for (std::size_t r = 0; r < certificate.rule_counts().size(); ++r) {
    const RuleCount& count = certificate.rule_counts()[r];
    if (count.violations == 0) continue;
    const Rule& rule = certificate.rules.rules[r];
    broken.rules.push_back(rule);
    const auto worst = worst_state(student.net, rule, count);
    if (worst) {
      text += fmt::format("  worst for \"{}\": {} at {}\n", rule.name, action_name(worst->action),
                          state_text(worst->state, student.net.context.kind));
    } else if (!count.counterexamples.empty()) {
      text += fmt::format("  one for \"{}\": {}\n", rule.name,
                          state_text(count.counterexamples.front(), student.net.context.kind));
    }
  }
  if (broken.empty() || market.days.empty()) return text;
  if (student.net.context.is_outlook()) {
    return text + "  shares of decisions are not counted: this student needs day-ahead prices\n";
  }
  RuleWatch watch(std::make_shared<StudentPolicy>(student.net), broken, student.net.context, 0,
                  config.train.seed);
  evaluate(market, market.days, watch, {config.battery, config.initial_soc_frac, true});
  for (std::size_t r = 0; r < broken.rules.size(); ++r) {
    if (!can_be_projected(broken.rules[r])) {
      text += fmt::format(
          "  \"{}\" compares pairs of states: it cannot be counted in single decisions\n",
          broken.rules[r].name);
      continue;
    }
    const WatchCount& count = watch.counts()[r];
    text += fmt::format(
        "  \"{}\" is broken in {} of {} decisions ({:.3f} %)\n", broken.rules[r].name,
        count.visited_broken, watch.decisions(),
        100.0 * static_cast<double>(count.visited_broken) / static_cast<double>(watch.decisions()));
  }
  return text;
}

ProgramOption RuleFiles::add(ProgramCommand& command, const std::string& help) {
  return command.option("--rules", paths, help);
}

RuleSet RuleFiles::read() const { return load_rules(paths); }

void use_rules(RunConfig& config, const RuleSet& rules, ContextKind kind) {
  PriceThresholds& thresholds = config.distil.correction.thresholds;
  require_consistent(rules, thresholds, kind);
  config.distil.rules = rules;
  thresholds = rules.thresholds(thresholds);
}

void RuleFiles::apply(RunConfig& config, ContextKind kind) const {
  if (!paths.empty()) use_rules(config, read(), kind);
}

}  // namespace bess
