#include "edge/app/commands/command.h"

#include <unistd.h>

#include <cstdio>

#include "edge/core/control/policy.h"
#include "edge/records/log/journal.h"
#include "edge/records/why/explanation.h"
#include "edge/records/why/local_moment.h"
#include "shared/host/embed/build_info.h"
#include "shared/host/text.h"

namespace bess {
namespace {

std::string version_text() {
  return formatted("bess-edge " BESS_VERSION ", student %08x: %s\n", student_hash(),
                   student_provenance()) +
         build_line();
}

}  // namespace

ProgramOption EdgeCommand::config() {
  return option("--config", chosen_->settings.path,
                std::string("settings of the controller; default: ") + kDefaultConfigPath)
      .value_name("FILE");
}

ProgramOption EdgeCommand::duration(const std::string& name, std::int64_t& seconds,
                                    std::int64_t shortest_s, const std::string& help) {
  const auto take = [&seconds, shortest_s](const std::string& given) -> std::string {
    if (parse_duration(given, seconds) && seconds >= shortest_s) return "";
    const bool is_minutes = shortest_s % 60 == 0;
    return "must be " + std::to_string(is_minutes ? shortest_s / 60 : shortest_s) +
           (is_minutes ? "m" : "s") + " to 7d, such as 2h or 1h30m, not " + given;
  };
  return parsed(name, take, help).value_name("DURATION");
}

ProgramOption EdgeCommand::moment(const std::string& name, std::string& text,
                                  const std::string& help) {
  const auto complaint = [](const std::string& given) -> std::string {
    std::int64_t ignored = 0;
    if (parse_moment(given, 0, ignored)) return "";
    return "must be a time such as 14:32, yesterday, \"yesterday 14:32\", 2h (ago), "
           "\"2026-11-23 14:32\" or 2026-11-23T13:32:00Z, not " +
           given;
  };
  return option(name, text, help).value_name("MOMENT").check(complaint);
}

void EdgeCommand::does_without_settings(Action action, Complaint complaint) {
  runs(
      [chosen = chosen_, action = std::move(action)] {
        chosen->run = [chosen, action] { return action(chosen->settings); };
      },
      std::move(complaint));
}

void EdgeCommand::set_action(Action action, Complaint complaint) {
  config();
  does_without_settings(
      [action = std::move(action)](SettingsFile& settings) {
        const int code = load_settings(settings);
        return code != 0 ? code : action(settings);
      },
      std::move(complaint));
}

bool open_log(const EdgeConfig& config, LogReader& log) {
  FileMessage error;
  if (!log.open(config.log, error)) {
    failed(error.c_str());
    return false;
  }
  if (!error.empty()) {
    report(JournalLevel::kWarning, "note: %s: only the last 8 hours, of [state] run_folder",
           error.c_str());
  }
  return true;
}

int failed(const std::string& message) {
  report(JournalLevel::kError, "%s", message.c_str());
  return 1;
}

int end_of_output() {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return 0;
  return failed("the output cannot be written");
}

int load_settings(SettingsFile& settings) {
  if (settings.path.empty()) {
    if (access(kDefaultConfigPath, F_OK) != 0) {
      std::fprintf(stderr,
                   "bess-edge: %s does not exist: give --config FILE (see bess-edge --help)\n",
                   kDefaultConfigPath);
      return 2;
    }
    settings.path = kDefaultConfigPath;
  }
  std::string error;
  return load_edge_config(settings.path, settings.config, error) ? 0 : failed(error);
}

int run_command_line(int argc, const char* const* argv) {
  static SettingsFile settings;  // too large for the stack
  settings = {};
  ChosenCommand chosen{.settings = settings};
  {
    CommandLine line("bess-edge", "drive a battery by the imbalance price, every two minutes",
                     version_text());
    const EdgeCommand root(line.root(), chosen);
    for (const auto add :
         {add_commission, add_release, add_clear, add_status, add_log, add_why, add_earned,
          add_hold, add_limit, add_record, add_map_check, add_signature, add_run}) {
      add(root);
    }
    const int code = line.run(argc, argv);
    if (code != 0 || !chosen.run) return code;
  }
  return chosen.run();
}

}  // namespace bess
