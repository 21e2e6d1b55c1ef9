#include "edge/program/command_line.h"

#include <unistd.h>

#include <charconv>
#include <cstdio>
#include <string_view>
#include <variant>

#include "edge/control/policy.h"
#include "edge/program/command_help.h"
#include "edge/program/duration_text.h"
#include "shared/host/build_info.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

CommandLineResult usage_error(std::string_view message, std::string_view argument) {
  std::fprintf(stderr, "bess-edge: %.*s%.*s (see bess-edge --help)\n",
               static_cast<int>(message.size()), message.data(), static_cast<int>(argument.size()),
               argument.data());
  return CommandLineResult::kExitUsage;
}

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

bool parse_count(std::string_view text, std::int64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && value > 0;
}

/// Stores the option's value; false after printing what is wrong with it.
bool store(const Option& option, std::string_view value, CommandLine& line) {
  if (const auto* text = std::get_if<std::string CommandLine::*>(&option.target)) {
    line.*(*text) = value;
    if (!value.empty()) return true;  // "$UNSET" must not mean the installed file
    usage_error(std::string(option.name) + " needs a file, not an empty text", "");
    return false;
  } else if (const auto* count = std::get_if<std::int64_t CommandLine::*>(&option.target)) {
    if (parse_count(value, line.*(*count))) return true;
    usage_error(std::string(option.name) + " needs a whole number above 0, not ", value);
    return false;
  } else if (const auto* instant = std::get_if<UtcInstant>(&option.target)) {
    if (parse_utc(value, line.*(instant->utc_s))) return true;
    usage_error(std::string(option.name) + " needs an instant such as 2026-11-21T06:00:00Z, not ",
                value);
    return false;
  } else if (const auto* duration = std::get_if<Duration>(&option.target)) {
    std::int64_t shortest_s = 0;
    static_cast<void>(parse_duration(duration->shortest, shortest_s));
    std::int64_t& seconds = line.*(duration->seconds);
    if (parse_duration(value, seconds) && seconds >= shortest_s) return true;
    usage_error(std::string(option.name) + " needs " + std::string(duration->shortest) +
                    " to 7d, such as 2h or 1h30m, not ",
                value);
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

/// `map` is said with what is to be done with it; `--help` may stand there as well.
bool take_map_verb(int argc, char** argv, int& i) {
  if (i < argc && argv[i] == std::string_view("check")) return ++i, true;
  return i < argc && argv[i][0] == '-' &&
         (argv[i] == std::string_view("--help") || argv[i] == std::string_view("-h"));
}

CommandLineResult settle_config(CommandLine& line) {
  if (!line.config_path.empty()) return CommandLineResult::kGo;
  if (access(kDefaultConfigPath, F_OK) != 0) {
    return usage_error("--config FILE is required, there is no ", kDefaultConfigPath);
  }
  line.config_path = kDefaultConfigPath;
  return CommandLineResult::kGo;
}

/// A map that is named needs no configuration.
CommandLineResult settle_map_check(CommandLine& line) {
  if (line.against_path.empty()) return usage_error("map check needs --against FILE", "");
  if (!line.map_path.empty() && !line.config_path.empty()) {
    return usage_error("--map and --config exclude each other", "");
  }
  if (line.map_path.empty() && !line.variant.empty()) {
    return usage_error("--variant needs --map: a configuration says it itself", "");
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

bool print_general(std::string_view argument, SubCommand command) {
  if (argument == "--help" || argument == "-h") {
    std::fputs(help_of(command), stdout);
    return true;
  }
  if (argument != "--version") return false;
  std::printf("bess-edge %s, student %08x: %s\n%s\n", BESS_VERSION, student_hash(),
              student_provenance(), build_line().c_str());
  return true;
}

}  // namespace

CommandLineResult parse_command_line(int argc, char** argv, CommandLine& line) {
  int i = 1;
  if (i < argc && argv[i][0] != '-') {
    const std::string_view name = argv[i++];
    if (!find_command(name, line.command)) return usage_error("unknown command ", name);
    if (line.command == SubCommand::kMapCheck && !take_map_verb(argc, argv, i)) {
      return usage_error("map needs what is to be done: map check --against FILE", "");
    }
  }
  const SubCommand command = line.command;  // --check is an option of run and changes line.command
  for (; i < argc; ++i) {
    if (print_general(argv[i], command)) return CommandLineResult::kExitOk;
    if (take_hold_power(argv[i], line)) continue;
    const Option* const option = find_option(command, argv[i]);
    if (option == nullptr) return usage_error("unknown option ", argv[i]);
    if (set_switch(*option, line)) continue;
    if (i + 1 == argc) return usage_error("a value is missing after ", argv[i]);
    if (!store(*option, argv[++i], line)) return CommandLineResult::kExitUsage;
  }
  if (line.json && line.prometheus)
    return usage_error("--json and --prometheus exclude each other", "");
  if (line.command == SubCommand::kHold && !is_complete_hold(line)) {
    return usage_error("hold needs a power in W and --for DURATION, or --release alone", "");
  }
  const bool needs_no_settings =
      line.command == SubCommand::kSignature || line.command == SubCommand::kHistory;
  if (needs_no_settings) return CommandLineResult::kGo;
  if (line.command == SubCommand::kLimit && line.clear != (line.for_s == 0)) {
    return usage_error("limit needs either --for DURATION or --clear", "");
  }
  if (line.command == SubCommand::kRecord && line.for_s == 0) {
    return usage_error("record needs --for DURATION", "");
  }
  if (line.command == SubCommand::kMapCheck) return settle_map_check(line);
  return settle_config(line);
}

}  // namespace bess
