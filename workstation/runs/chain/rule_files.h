// The option --rules of several commands, and what a certificate and a student say about rules.
#pragma once

#include <string>
#include <vector>

#include "shared/host/command_line.h"
#include "shared/host/json.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {

// What a proof found of an operator's rules, in lines and in JSON.

/// A line a rule: violations, or that it is the guard's alone. Empty without rules.
std::string rule_count_lines(const Certificate& certificate);

/// "rules": a list of objects; nothing without rules.
void add_certificate(const Certificate& certificate, Json& json);

/// Of each broken rule the worst state, and the share of decisions on the days of `market` that
/// break it, the SoC carried over; without days there is no share.
std::string broken_rule_lines(const StudentFile& student, const MarketSteps& market,
                              const RunConfig& config);

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
