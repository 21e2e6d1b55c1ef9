// Options shared by several subcommands, with their names and ranges, and values of others.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "shared/host/command_line.h"
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

}  // namespace bess
