// Option --rules, and the results of a proof for rules.
#pragma once

#include <string>
#include <vector>

#include "shared/host/command_line.h"
#include "shared/host/json.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {

// Results of a proof for operator rules, as text and JSON.

/// One line per rule: violations, or that only the guard enforces it. Empty without rules.
std::string rule_count_lines(const Certificate& certificate);

/// Adds the certificate, with "rules" as a list of objects.
void add_certificate(const Certificate& certificate, Json& json);

/// For each broken rule the worst state and, with days in `market`, the share of decisions that
/// break it (SoC carried over).
std::string broken_rule_lines(const StudentFile& student, const MarketSteps& market,
                              const RunConfig& config);

/// Adds rules to a distillation; their thresholds replace the configured ones. Throws UserError
/// when rules conflict.
void use_rules(RunConfig& config, const RuleSet& rules, ContextKind kind);

struct RuleFiles {
  std::vector<std::string> paths;

  /// Declares --rules.
  ProgramOption add(ProgramCommand& command, const std::string& help);

  /// Empty without the option.
  [[nodiscard]] RuleSet read() const;
  /// use_rules() of read(); no effect without the option.
  void apply(RunConfig& config, ContextKind kind) const;
};

}  // namespace bess
