#include "edge/commands/command_line.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <string_view>
#include <variant>
#include <vector>

#include "edge/commands/command_help.h"
#include "edge/commands/duration_text.h"
#include "edge/control/policy.h"
#include "shared/host/build_info.h"
#include "shared/host/nearest_word.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

struct UtcInstant {
  std::int64_t CommandLine::*utc_s;
};

struct Duration {
  std::int64_t CommandLine::*seconds;
  std::string_view shortest;
};

/// What an option sets: a switch, a count above 0, a text, an instant, or how long.
using Target = std::variant<bool CommandLine::*, std::int64_t CommandLine::*,
                            std::string CommandLine::*, UtcInstant, Duration, SubCommand>;

struct CommandName {
  std::string_view name;
  SubCommand command;
};

constexpr CommandName kCommandNames[] = {
    {"run", SubCommand::kRun},
    {"commission", SubCommand::kCommission},
    {"status", SubCommand::kStatus},
    {"log", SubCommand::kLog},
    {"hold", SubCommand::kHold},
    {"limit", SubCommand::kLimit},
    {"release", SubCommand::kRelease},
    {"clear", SubCommand::kClear},
    {"signature", SubCommand::kSignature},
    {"record", SubCommand::kRecord},
    {"map", SubCommand::kMapCheck},
    {"history", SubCommand::kHistory},
};

/// `topic`: of which command the help knows more; run: of all.
CommandLineResult usage_error(SubCommand topic, const std::string& message) {
  std::string help = "bess-edge ";
  for (const CommandName& known : kCommandNames) {
    const bool is_it = known.command == topic && topic != SubCommand::kRun;
    if (is_it) help.append(known.name).append(topic == SubCommand::kMapCheck ? " check " : " ");
  }
  std::fprintf(stderr, "bess-edge: %s (see %s--help)\n", message.c_str(), help.c_str());
  return CommandLineResult::kExitUsage;
}

bool find_command(std::string_view name, SubCommand& command) {
  for (const CommandName& known : kCommandNames) {
    if (known.name != name) continue;
    command = known.command;
    return true;
  }
  return false;
}

struct Option {
  SubCommand command;
  std::string_view name;
  Target target;
};

constexpr Option kOptions[] = {
    {SubCommand::kRun, "--config", &CommandLine::config_path},
    {SubCommand::kRun, "--check", SubCommand::kCheck},
    {SubCommand::kRun, "--self-test", SubCommand::kSelfTest},
    {SubCommand::kRun, "--dry-run", &CommandLine::dry_run},
    {SubCommand::kRun, "--cycles", &CommandLine::cycles},
    {SubCommand::kCommission, "--config", &CommandLine::config_path},
    {SubCommand::kCommission, "--yes", &CommandLine::yes},
    {SubCommand::kRelease, "--config", &CommandLine::config_path},
    {SubCommand::kRelease, "--yes", &CommandLine::yes},
    {SubCommand::kRelease, "--force", &CommandLine::force},
    {SubCommand::kClear, "--config", &CommandLine::config_path},
    {SubCommand::kClear, "--yes", &CommandLine::yes},
    {SubCommand::kStatus, "--config", &CommandLine::config_path},
    {SubCommand::kStatus, "--json", &CommandLine::json},
    {SubCommand::kStatus, "--prometheus", &CommandLine::prometheus},
    {SubCommand::kStatus, "--follow", &CommandLine::follow},
    {SubCommand::kStatus, "--no-lock", &CommandLine::no_lock},
    {SubCommand::kLog, "--config", &CommandLine::config_path},
    {SubCommand::kLog, "--csv", &CommandLine::csv},
    {SubCommand::kLog, "--last", &CommandLine::last},
    {SubCommand::kLog, "--since", UtcInstant{&CommandLine::since_utc_s}},
    {SubCommand::kHold, "--config", &CommandLine::config_path},
    {SubCommand::kHold, "--for", Duration{&CommandLine::for_s, "2m"}},
    {SubCommand::kHold, "--release", &CommandLine::release_hold},
    {SubCommand::kLimit, "--config", &CommandLine::config_path},
    {SubCommand::kLimit, "--charge", &CommandLine::charge_w},
    {SubCommand::kLimit, "--discharge", &CommandLine::discharge_w},
    {SubCommand::kLimit, "--for", Duration{&CommandLine::for_s, "1s"}},
    {SubCommand::kLimit, "--clear", &CommandLine::clear},
    {SubCommand::kRun, "--record", &CommandLine::record_path},
    {SubCommand::kRecord, "--config", &CommandLine::config_path},
    {SubCommand::kRecord, "--for", Duration{&CommandLine::for_s, "1s"}},
    {SubCommand::kRecord, "--every", Duration{&CommandLine::every_s, "1s"}},
    {SubCommand::kRecord, "--out", &CommandLine::out_path},
    {SubCommand::kMapCheck, "--config", &CommandLine::config_path},
    {SubCommand::kMapCheck, "--map", &CommandLine::map_path},
    {SubCommand::kMapCheck, "--variant", &CommandLine::variant},
    {SubCommand::kMapCheck, "--against", &CommandLine::against_path},
    {SubCommand::kMapCheck, "--accept-cut", &CommandLine::accept_cut},
    {SubCommand::kMapCheck, "--json", &CommandLine::json},
    {SubCommand::kHistory, "--json", &CommandLine::json},
    {SubCommand::kHistory, "--folder", &CommandLine::update_folder},
};

const Option* find_option(SubCommand command, std::string_view name) {
  for (const Option& option : kOptions) {
    if (option.command == command && option.name == name) return &option;
  }
  return nullptr;
}

/// Of any command: those that share a name also share whether a value follows.
const Option* find_option(std::string_view name) {
  for (const Option& option : kOptions) {
    if (option.name == name) return &option;
  }
  return nullptr;
}

bool takes_value(const Option& option) {
  return !std::holds_alternative<bool CommandLine::*>(option.target) &&
         !std::holds_alternative<SubCommand>(option.target);
}

bool is_help(std::string_view word) { return word == "--help" || word == "-h"; }

std::vector<std::string> options_of(SubCommand command) {
  std::vector<std::string> names = {"--help", "--version"};
  for (const Option& option : kOptions) {
    if (option.command == command) names.emplace_back(option.name);
  }
  return names;
}

CommandLineResult unknown_command(std::string_view name) {
  std::vector<std::string> known = {"help", "version"};
  for (const CommandName& command : kCommandNames) known.emplace_back(command.name);
  std::string meant = did_you_mean(name, known);
  if (meant.empty()) meant = did_you_mean("--" + std::string(name), options_of(SubCommand::kRun));
  return usage_error(SubCommand::kRun, "unknown command " + std::string(name) + meant);
}

CommandLineResult unknown_option(SubCommand command, std::string_view name) {
  const std::string_view bare = name.substr(0, name.find('='));  // of --name=value
  return usage_error(
      command, "unknown option " + std::string(name) + did_you_mean(bare, options_of(command)));
}

bool parse_count(std::string_view text, std::int64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && value > 0;
}

/// Stores the option's value; false after printing what is wrong with it.
bool store(const Option& option, std::string_view value, CommandLine& line) {
  const std::string name(option.name);
  const std::string given(value);
  if (const auto* text = std::get_if<std::string CommandLine::*>(&option.target)) {
    line.*(*text) = value;
    if (!value.empty()) return true;  // "$UNSET" must not mean the installed file
    usage_error(option.command, name + " needs a file, not an empty text");
    return false;
  } else if (const auto* count = std::get_if<std::int64_t CommandLine::*>(&option.target)) {
    if (parse_count(value, line.*(*count))) return true;
    usage_error(option.command, name + " needs a whole number above 0, not " + given);
    return false;
  } else if (const auto* instant = std::get_if<UtcInstant>(&option.target)) {
    if (parse_utc(value, line.*(instant->utc_s))) return true;
    usage_error(option.command,
                name + " needs an instant such as 2026-11-21T06:00:00Z, not " + given);
    return false;
  } else if (const auto* duration = std::get_if<Duration>(&option.target)) {
    std::int64_t shortest_s = 0;
    static_cast<void>(parse_duration(duration->shortest, shortest_s));
    std::int64_t& seconds = line.*(duration->seconds);
    if (parse_duration(value, seconds) && seconds >= shortest_s) return true;
    usage_error(option.command, name + " needs " + std::string(duration->shortest) +
                                    " to 7d, such as 2h or 1h30m, not " + given);
    return false;
  }
  return true;
}

/// The power to hold stands alone, and a minus before it begins no option.
bool take_hold_power(std::string_view argument, CommandLine& line) {
  if (line.command != SubCommand::kHold || line.hold_power_w.has_value()) return false;
  if (argument.starts_with('+')) argument.remove_prefix(1);
  std::int64_t power_w = 0;
  const char* const last = argument.data() + argument.size();
  const auto [end, error] = std::from_chars(argument.data(), last, power_w);
  if (error != std::errc{} || end != last) return false;
  line.hold_power_w = power_w;
  return true;
}

/// Either a power and how long, or the end of what is held.
bool is_complete_hold(const CommandLine& line) {
  const bool is_order = line.hold_power_w.has_value() && line.for_s > 0;
  const bool is_partial = line.hold_power_w.has_value() || line.for_s > 0;
  return line.release_hold ? !is_partial : is_order;
}

CommandLineResult settle_config(CommandLine& line) {
  if (!line.config_path.empty()) return CommandLineResult::kGo;
  if (access(kDefaultConfigPath, F_OK) != 0) {
    return usage_error(line.command,
                       std::string("--config FILE is required, there is no ") + kDefaultConfigPath);
  }
  line.config_path = kDefaultConfigPath;
  return CommandLineResult::kGo;
}

/// A map that is named needs no configuration.
CommandLineResult settle_map_check(CommandLine& line) {
  const auto refuse = [](const char* why) { return usage_error(SubCommand::kMapCheck, why); };
  if (line.against_path.empty()) return refuse("map check needs --against FILE");
  if (!line.map_path.empty() && !line.config_path.empty()) {
    return refuse("--map and --config exclude each other");
  }
  if (line.map_path.empty() && !line.variant.empty()) {
    return refuse("--variant needs --map: a configuration says it itself");
  }
  return line.map_path.empty() ? settle_config(line) : CommandLineResult::kGo;
}

/// True when the option is complete without a value.
bool set_switch(const Option& option, CommandLine& line) {
  if (const auto* flag = std::get_if<bool CommandLine::*>(&option.target)) {
    return line.*(*flag) = true;
  }
  if (const auto* command = std::get_if<SubCommand>(&option.target)) {
    line.command = *command;
    return true;
  }
  return false;
}

CommandLineResult print_help(SubCommand command) {
  std::fputs(help_of(command), stdout);
  return CommandLineResult::kExitOk;
}

CommandLineResult print_version() {
  std::printf("bess-edge %s, student %08x: %s\n%s\n", BESS_VERSION, student_hash(),
              student_provenance(), build_line().c_str());
  return CommandLineResult::kExitOk;
}

using Words = std::vector<std::string_view>;

/// The first word that is neither an option nor its value: options may stand before the command. Behind an option
/// that no command knows nothing can be told.
std::size_t find_command_word(const Words& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!words[i].starts_with('-')) return i;
    if (is_help(words[i]) || words[i] == "--version") continue;
    const Option* const option = find_option(words[i]);
    if (option == nullptr) break;
    i += takes_value(*option) ? 1 : 0;
  }
  return words.size();
}

/// `map` is said with what is to be done with it.
CommandLineResult take_map_verb(Words& words, CommandLine& line) {
  const std::size_t at = find_command_word(words);
  const bool is_check = at < words.size() && words[at] == "check";
  if (is_check) words.erase(words.begin() + static_cast<std::ptrdiff_t>(at));
  if (is_check || std::any_of(words.begin(), words.end(), is_help)) return CommandLineResult::kGo;
  return usage_error(line.command, "map needs what is to be done: map check --against FILE");
}

/// Takes the command out of the words; `help [COMMAND]` and `version` are done with that.
CommandLineResult take_command(Words& words, CommandLine& line) {
  const std::size_t at = find_command_word(words);
  if (at >= words.size()) return CommandLineResult::kGo;
  std::string_view name = words[at];
  words.erase(words.begin() + static_cast<std::ptrdiff_t>(at));
  if (name == "version") return print_version();
  const bool is_help_word = name == "help";
  const bool is_of_all = is_help_word && (at >= words.size() || is_help(words[at]));
  if (is_of_all) return print_help(SubCommand::kRun);
  if (is_help_word) name = words[at];
  if (!find_command(name, line.command)) return unknown_command(name);
  if (is_help_word) return print_help(line.command);
  if (line.command != SubCommand::kMapCheck) return CommandLineResult::kGo;
  return take_map_verb(words, line);
}

CommandLineResult take_options(const Words& words, CommandLine& line) {
  const SubCommand command = line.command;  // --check is an option of run and changes line.command
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (is_help(words[i])) return print_help(command);
    if (words[i] == "--version") return print_version();
    if (take_hold_power(words[i], line)) continue;
    const Option* const option = find_option(command, words[i]);
    if (option == nullptr) return unknown_option(command, words[i]);
    if (set_switch(*option, line)) continue;
    if (i + 1 == words.size()) {
      return usage_error(command, "a value is missing after " + std::string(words[i]));
    }
    if (!store(*option, words[++i], line)) return CommandLineResult::kExitUsage;
  }
  return CommandLineResult::kGo;
}

/// What the options of a command must be together, and where its settings are.
CommandLineResult settle(CommandLine& line) {
  const auto refuse = [&](const char* why) { return usage_error(line.command, why); };
  switch (line.command) {
    case SubCommand::kSignature:
    case SubCommand::kHistory:
      return CommandLineResult::kGo;  // needs no settings
    case SubCommand::kMapCheck:
      return settle_map_check(line);
    case SubCommand::kStatus:
      if (line.json && line.prometheus) return refuse("--json and --prometheus exclude each other");
      break;
    case SubCommand::kHold:
      if (is_complete_hold(line)) break;
      return refuse("hold needs a power in W and --for DURATION, or --release alone");
    case SubCommand::kLimit:
      if (line.clear == (line.for_s == 0)) break;
      return refuse("limit needs either --for DURATION or --clear");
    case SubCommand::kRecord:
      if (line.for_s == 0) return refuse("record needs --for DURATION");
      break;
    default:
      break;
  }
  return settle_config(line);
}

}  // namespace

CommandLineResult parse_command_line(int argc, char** argv, CommandLine& line) {
  Words words(argv + std::min(argc, 1), argv + argc);
  CommandLineResult result = take_command(words, line);
  if (result == CommandLineResult::kGo) result = take_options(words, line);
  return result == CommandLineResult::kGo ? settle(line) : result;
}

}  // namespace bess
