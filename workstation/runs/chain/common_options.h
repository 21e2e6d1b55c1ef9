// Options shared by several subcommands, with their names and ranges, and values of others.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "shared/host/command_line.h"
#include "shared/host/json.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {

struct CommonOptions {
  std::string config_path;
  std::optional<std::uint64_t> seed;
  std::optional<int> threads;
  std::optional<int> delay_min;
  std::optional<std::string> settlement;
  std::optional<double> initial_soc_frac;

  void add_config(ProgramCommand& command);
  void add_threads(ProgramCommand& command);
  void add_market(ProgramCommand& command);
  void add_all(ProgramCommand& command) {
    add_market(command);
    add_config(command);
    command.option("--seed", seed, "random seed (default 1)").non_negative();
    add_threads(command);
  }

  /// Configuration file overlaid with the command line's options.
  [[nodiscard]] RunConfig resolve(ContextKind unless_said = ContextKind::kLevel) const;
  /// The same on top of `config`; ignores --config.
  [[nodiscard]] RunConfig resolve(RunConfig config) const;
};

/// Each text as a number from `low` to `high`. Throws UserError "`option` TEXT: use `usage`".
std::vector<double> numbers_in(const std::vector<std::string>& texts, double low, double high,
                               const std::string& option, const std::string& usage);

/// Root of a web API without a trailing slash. Throws UserError naming `option` if malformed.
std::string checked_base_url(std::string url, const std::string& option);

/// edge/generated/student_weights.h of the source tree around `folder`, if any.
std::optional<std::filesystem::path> header_in_tree_around(const std::filesystem::path& folder);

/// The same around the current folder, else around this program: the header that `export` writes.
/// Throws UserError with a remedy when neither is in a source tree.
std::filesystem::path header_to_replace();

// Option --rules, and the results of a proof for rules.

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
