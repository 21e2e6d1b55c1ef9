// The option --rules, as several commands have it.
#pragma once

#include <string>
#include <vector>

#include "shared/host/command_line.h"
#include "workstation/chain/run_config.h"
#include "workstation/rules/rule.h"

namespace bess {

/// Into a distillation: the rules, with their thresholds in place of the configured ones. Throws
/// UserError when they contradict each other.
void use_rules(RunConfig& config, const RuleSet& rules, ContextKind kind);

class RuleFiles {
 public:
  /// Declares --rules.
  ProgramOption add(ProgramCommand& command, const std::string& help);

  [[nodiscard]] bool given() const { return !paths_.empty(); }
  /// None when the option was not given.
  [[nodiscard]] RuleSet read() const;
  /// use_rules() of read(); nothing when the option was not given.
  void apply(RunConfig& config, ContextKind kind) const;

 private:
  std::vector<std::string> paths_;
};

}  // namespace bess
