// Command line of bess-edge. Each NAME_command.cpp declares one command, with its options in one
// struct.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "edge/app/settings/edge_config.h"
#include "edge/records/log/log_reader.h"
#include "shared/host/command_line.h"

namespace bess {

inline constexpr const char* kDefaultConfigPath = "/etc/bess/edge.toml";

/// Settings of the controller and the file they come from.
struct SettingsFile {
  std::string path;
  EdgeConfig config;
};

/// Chosen command; it runs after parsing and returns the exit code.
struct ChosenCommand {
  SettingsFile& settings;
  std::function<int()> run{};
};

class EdgeCommand : public ProgramCommand {
 public:
  EdgeCommand(ProgramCommand command, ChosenCommand& chosen)
      : ProgramCommand(command), chosen_(&chosen) {}
  EdgeCommand subcommand(const std::string& name, const std::string& description) {
    return {ProgramCommand::subcommand(name, description), *chosen_};
  }

  /// --config FILE
  ProgramOption config();
  /// 90s, 2h, 1h30m: from `shortest_s` to 7 days.
  ProgramOption duration(const std::string& name, std::int64_t& seconds, std::int64_t shortest_s,
                         const std::string& help);
  /// Text that parse_moment() accepts; "14:32" is resolved when the command runs.
  ProgramOption moment(const std::string& name, std::string& text, const std::string& help);

  using Action = std::function<int(SettingsFile&)>;
  using Complaint = std::function<std::string()>;
  /// Takes --config, and loads the settings before `action`. `complaint`: as ProgramCommand::runs.
  void set_action(Action action, Complaint complaint = nullptr);
  /// Loads no settings; `action` may load them.
  void does_without_settings(Action action, Complaint complaint = nullptr);

 private:
  ChosenCommand* chosen_;
};

/// Loads the file of --config, or the installed one. 0, or the exit code after one error line: 2
/// without a file, 1 with a wrong one.
int load_settings(SettingsFile& settings);

/// Reports one line on stderr or in the journal. Returns exit code 1.
int failed(const std::string& message);

/// Flushes stdout: 0, or exit code 1 after one line if the output cannot be written.
int end_of_output();
/// False after one line if no log can be read; a note if only the last hours can.
bool open_log(const EdgeConfig& config, LogReader& log);

// Commands in the order of the help.

void add_commission(EdgeCommand root);
void add_release(EdgeCommand root);
void add_clear(EdgeCommand root);
void add_status(EdgeCommand root);
void add_log(EdgeCommand root);
void add_why(EdgeCommand root);
void add_earned(EdgeCommand root);
void add_hold(EdgeCommand root);
void add_limit(EdgeCommand root);
void add_record(EdgeCommand root);
void add_map_check(EdgeCommand root);
void add_signature(EdgeCommand root);
/// bess-edge without a command. Last, because later commands would inherit its footer.
void add_run(EdgeCommand root);

/// Runs the command; an error is one line on stderr. Returns the exit code of the process.
int run_command_line(int argc, const char* const* argv);

// Check of settings, battery, meter and prices: `bess-edge --check`; and self-test of machine and
// site for the controller: `bess-edge --self-test`. Both write nothing to the battery.

/// Result of `bess-prices --check`, for --check and --self-test.
struct PriceCheck {
  bool is_well = false;
  std::string lines;  ///< its output, then its errors
};

/// Runs bess-prices from the folder of this program.
PriceCheck check_prices(const std::string& config_path);

/// `path`: settings file. Findings go to stdout, errors to stderr. Exit code 0, or 1 if the
/// controller would not run.
int run_check(const EdgeConfig& config, const std::string& path);

/// Prints one line per part: ok, note or FAIL. Exit code 0, or 1 if a part fails.
int run_self_test(const EdgeConfig& config, const std::string& config_path);

}  // namespace bess
