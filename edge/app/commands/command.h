// A command of bess-edge while it is declared, and the list of all: each NAME_command.cpp declares
// one, its options into a struct of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "edge/app/settings/edge_config.h"
#include "shared/host/command_line.h"

namespace bess {

inline constexpr const char* kDefaultConfigPath = "/etc/bess/edge.toml";

/// The controller's settings, and where they were read.
struct SettingsFile {
  std::string path;
  EdgeConfig config;
};

/// What the command line chose: it runs when the command line is gone. The exit code.
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
  /// A text that parse_moment() takes; what "14:32" means is known when the command runs.
  ProgramOption moment(const std::string& name, std::string& text, const std::string& help);

  using Action = std::function<int(SettingsFile&)>;
  using Complaint = std::function<std::string()>;
  /// Takes --config, and loads the settings before `action`. `complaint`: as ProgramCommand::runs.
  void does(Action action, Complaint complaint = nullptr);
  /// The settings are those by default, or what `action` loads.
  void does_without_settings(Action action, Complaint complaint = nullptr);

 private:
  ChosenCommand* chosen_;
};

/// Of --config, or the installed ones. 0; otherwise the exit code, and one line said why: 2 where
/// there are none, 1 where they are bad.
int load_settings(SettingsFile& settings);

/// One line on stderr, or in the journal; the exit code.
int failed(const std::string& message);

// The commands of bess-edge, in the order of its help. NAME_command.cpp declares each.

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
/// What bess-edge does without a command. Last: commands declared later would have its footer.
void add_run(EdgeCommand root);

}  // namespace bess
