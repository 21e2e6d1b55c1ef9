#include "workstation/chain/rule_files.h"

#include "workstation/rules/rule_conflicts.h"
#include "workstation/rules/rule_file.h"

namespace bess {

ProgramOption RuleFiles::add(ProgramCommand& command, const std::string& help) {
  return command.option("--rules", paths_, help);
}

RuleSet RuleFiles::read() const { return load_rules(paths_); }

void use_rules(RunConfig& config, const RuleSet& rules, ContextKind kind) {
  PriceThresholds& thresholds = config.distil.correction.thresholds;
  require_consistent(rules, thresholds, kind);
  config.distil.rules = rules;
  thresholds = rules.thresholds(thresholds);
}

void RuleFiles::apply(RunConfig& config, ContextKind kind) const {
  if (given()) use_rules(config, read(), kind);
}

}  // namespace bess
