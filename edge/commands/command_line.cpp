#include "edge/commands/command_line.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "edge/commands/command_list.h"
#include "edge/control/policy.h"
#include "edge/log/journal.h"
#include "shared/host/made/build_info.h"
#include "shared/host/nearest_word.h"

namespace bess {
namespace {

constexpr CommandOption kConfig = OptionsOf<SettingsFile>::text<&SettingsFile::path>("--config");
/// Where the rows of the other commands stand in the help of a run.
constexpr std::string_view kRowsMark = "(commands)\n";

bool is_help(std::string_view word) { return word == "--help" || word == "-h"; }

const EdgeCommand* find_command(std::string_view name) {
  const auto found = std::find_if(std::begin(kCommands), std::end(kCommands),
                                  [&](const EdgeCommand* known) { return known->name == name; });
  return found == std::end(kCommands) ? nullptr : *found;
}

const CommandOption* find_option(const EdgeCommand& command, std::string_view name) {
  for (const CommandOption& option : command.options) {
    if (!name.empty() && option.name == name) return &option;
  }
  return nullptr;
}

bool takes_config(const EdgeCommand& command) {
  return command.settings != EdgeCommand::Settings::kNone;
}

/// Of any command: those that share a name also share whether a value follows.
std::optional<bool> takes_value(std::string_view name) {
  if (name == kConfig.name) return kConfig.takes_value;
  for (const EdgeCommand* const command : kCommands) {
    if (const CommandOption* const option = find_option(*command, name)) return option->takes_value;
  }
  return std::nullopt;
}

std::vector<std::string> options_of(const EdgeCommand& command) {
  std::vector<std::string> names;
  for (const char* const name : {"--help", "--version"}) names.emplace_back(name);
  if (takes_config(command)) names.emplace_back(kConfig.name);
  for (const CommandOption& option : command.options) {
    if (!option.name.empty()) names.emplace_back(option.name);
  }
  return names;
}

int unknown_command(std::string_view name) {
  std::vector<std::string> known = {"help", "version"};
  for (const EdgeCommand* const command : kCommands) known.emplace_back(command->name);
  std::string meant = did_you_mean(name, known);
  if (meant.empty()) meant = did_you_mean("--" + std::string(name), options_of(kRunCommand));
  return usage_error(kRunCommand, "unknown command " + std::string(name) + meant);
}

int unknown_option(const EdgeCommand& command, std::string_view name) {
  const std::string_view bare = name.substr(0, name.find('='));  // of --name=value
  return usage_error(
      command, "unknown option " + std::string(name) + did_you_mean(bare, options_of(command)));
}

int print_help(const EdgeCommand& command) {
  std::fputs(&command == &kRunCommand ? general_help().c_str() : command.help, stdout);
  return 0;
}

int print_version() {
  std::printf("bess-edge %s, student %08x: %s\n%s\n", BESS_VERSION, student_hash(),
              student_provenance(), build_line().c_str());
  return 0;
}

/// The first word that is neither an option nor its value: options may stand before the command.
/// Behind an option that no command knows nothing can be told.
std::size_t find_command_word(const Words& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!words[i].starts_with('-')) return i;
    if (is_help(words[i]) || words[i] == "--version") continue;
    const std::optional<bool> has_value = takes_value(words[i]);
    if (!has_value) break;
    i += *has_value ? 1 : 0;
  }
  return words.size();
}

/// Takes that word away; empty when there is none.
std::string_view take_command_word(Words& words) {
  const std::size_t at = find_command_word(words);
  if (at >= words.size()) return {};
  const std::string_view word = words[at];
  words.erase(words.begin() + static_cast<std::ptrdiff_t>(at));
  return word;
}

/// `map` is said with what is to be done with it.
bool take_verb(const EdgeCommand& command, Words& words) {
  const std::size_t at = find_command_word(words);
  const bool is_said = at < words.size() && words[at] == command.verb_word();
  if (is_said) words.erase(words.begin() + static_cast<std::ptrdiff_t>(at));
  return is_said || std::any_of(words.begin(), words.end(), is_help);
}

/// `help [COMMAND]`
int help_on(Words words) {
  const std::string_view name = take_command_word(words);
  const EdgeCommand* const command = name.empty() ? &kRunCommand : find_command(name);
  return command != nullptr ? print_help(*command) : unknown_command(name);
}

bool is_lone_word(const EdgeCommand& command, void* given, std::string_view word) {
  std::string wants;
  return std::any_of(command.options.begin(), command.options.end(), [&](const auto& option) {
    return option.name.empty() && option.store(given, word, wants);
  });
}

std::string row_of(std::string_view usage, std::string_view does) {
  constexpr std::size_t kColumn = 44;
  std::string row = "  bess-edge ";
  row += usage;
  row.append(usage.size() < kColumn ? kColumn - usage.size() : 1, ' ');
  row += does;
  return row += '\n';
}

}  // namespace

std::string general_help() {
  const std::string_view text = kRunCommand.help;
  const std::size_t mark = text.find(kRowsMark);
  std::string help(text.substr(0, mark));
  for (const EdgeCommand* const command : kCommands) {
    if (command != &kRunCommand) help += row_of(command->usage, command->does);
  }
  help += row_of("help [COMMAND]", "this text, or more on one of them");
  help += row_of("version", "version and the student that is built in");
  return help.append(text.substr(mark + kRowsMark.size()));
}

int usage_error(const EdgeCommand& command, const std::string& message) {
  std::string words = "bess-edge ";
  if (&command != &kRunCommand) words.append(command.name).append(" ");
  if (!command.verb.empty()) words.append(command.verb_word()).append(" ");
  std::fprintf(stderr, "bess-edge: %s (see %s--help)\n", message.c_str(), words.c_str());
  return 2;
}

int failed(const std::string& message) {
  report(JournalLevel::kError, "%s", message.c_str());
  return 1;
}

std::optional<int> take_options(const EdgeCommand& command, const Words& words, void* given,
                                SettingsFile& settings) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (is_help(words[i])) return print_help(command);
    if (words[i] == "--version") return print_version();
    if (is_lone_word(command, given, words[i])) continue;
    const bool is_config = takes_config(command) && words[i] == kConfig.name;
    const CommandOption* const option = is_config ? &kConfig : find_option(command, words[i]);
    if (option == nullptr) return unknown_option(command, words[i]);
    if (option->takes_value && ++i == words.size()) {
      return usage_error(command, "a value is missing after " + std::string(option->name));
    }
    std::string wants;
    void* const target = is_config ? static_cast<void*>(&settings) : given;
    if (option->store(target, words[i], wants)) continue;
    std::string complaint(option->name);
    complaint.append(" needs ").append(wants);
    if (!words[i].empty()) complaint.append(", not ").append(words[i]);
    return usage_error(command, complaint);
  }
  return std::nullopt;
}

SettingsFile& settings_of_the_command() {
  static SettingsFile settings;
  settings = {};
  return settings;
}

std::optional<int> load_settings(const EdgeCommand& command, SettingsFile& settings) {
  if (settings.path.empty()) {
    if (access(kDefaultConfigPath, F_OK) != 0) {
      return usage_error(
          command, std::string("--config FILE is required, there is no ") + kDefaultConfigPath);
    }
    settings.path = kDefaultConfigPath;
  }
  std::string error;
  if (load_edge_config(settings.path, settings.config, error)) return std::nullopt;
  return failed(error);
}

int run_command_line(Words words) {
  const std::string_view name = take_command_word(words);
  if (name == "version") return print_version();
  if (name == "help") return help_on(std::move(words));
  const EdgeCommand* const command = name.empty() ? &kRunCommand : find_command(name);
  if (command == nullptr) return unknown_command(name);
  if (!command->verb.empty() && !take_verb(*command, words)) {
    return usage_error(*command, std::string(name) + " needs what is to be done: " +
                                     std::string(name) + " " + std::string(command->verb));
  }
  return command->run(*command, words);
}

}  // namespace bess
