#include "workstation/cli/rule_files.h"

#include "workstation/rules/rule_conflicts.h"
#include "workstation/rules/rule_file.h"

namespace bess {

ProgramOption RuleFiles::add(ProgramCommand& command, const std::string& help) {
  return command.option("--rules", paths_, help);
}

RuleSet RuleFiles::read() const { return load_rules(paths_); }

void RuleFiles::apply(RunConfig& config, ContextKind kind) const {
  if (!given()) return;
  config.distil.rules = read();
  PriceThresholds& thresholds = config.distil.correction.thresholds;
  require_consistent(config.distil.rules, thresholds, kind);
  thresholds = config.distil.rules.thresholds(thresholds);
}

}  // namespace bess
