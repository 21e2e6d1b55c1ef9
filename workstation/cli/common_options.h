// Options that several subcommands share, and what they resolve to: one place for their names and ranges.
#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "shared/host/command_line.h"
#include "workstation/cli/run_config.h"

namespace bess {

struct CommonOptions {
  std::string config_path;
  std::optional<std::uint64_t> seed;
  std::optional<int> threads;
  std::optional<int> delay_min;
  std::optional<std::string> settlement;
  std::optional<double> initial_soc_frac;

  void add_config(ProgramCommand& command);
  void add_seed_and_threads(ProgramCommand& command);
  void add_market(ProgramCommand& command);

  /// The configuration file with the command line's options on top.
  [[nodiscard]] RunConfig resolve() const;
};

/// Ctrl-C and SIGTERM end the program at once, with exit code 3: nothing half-written lies under a
/// final name. For commands that have nothing to save.
void end_when_interrupted();
/// From here on they only raise the flag: long loops look at it, save what they have and return.
void watch_interruption();
std::atomic<bool>& interruption();
/// Returns within a tenth of a second once interrupted.
void sleep_unless(double seconds, const std::atomic<bool>& interrupted);

/// The root of a web API without its last slash; throws UserError naming `option` when it is none.
std::string checked_base_url(std::string url, const std::string& option);

}  // namespace bess
