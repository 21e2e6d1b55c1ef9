#include "shared/host/command_line.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <optional>
#include <system_error>
#include <type_traits>

#include "shared/host/text.h"

namespace bess {
namespace {

void complain_of_output(const char* program, int error) {
  std::fprintf(stderr, "%s: cannot write to standard output: %s\n", program, std::strerror(error));
}

std::vector<std::string> subcommand_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(sub->get_name());
  }
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// Full name of a command: "bess-train prices fetch".
std::string words_of(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  return (parent == nullptr ? "" : words_of(*parent) + " ") + command.get_name();
}

/// Selected command: the root, or the innermost subcommand given.
const CLI::App& asked_command(const CLI::App& root) {
  const CLI::App* command = &root;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  return *command;
}

/// Error messages of CLI11 about values, in the style of this program.
std::string in_our_words(const std::string& what) {
  constexpr std::string_view kNoNumber = "Could not convert: ";
  constexpr std::string_view kTwice = ": At Most 1 required but received ";
  if (what.starts_with(kNoNumber)) {  // "Could not convert: --seed = 1.5"
    const std::string rest = what.substr(kNoNumber.size());
    const std::size_t equals = rest.find(" = ");
    if (equals == rest.npos) return rest + " is not a valid number";
    return rest.substr(0, equals) + ": " + rest.substr(equals + 3) +
           " is not a valid number of this kind (e.g. not a whole number)";
  }
  const std::size_t twice = what.find(kTwice);
  if (twice == what.npos) return what;
  return what.substr(0, twice) + ": given " + what.substr(twice + kTwice.size()) +
         " times; give it once (lists with commas)";
}

/// Error of a command line. Unknown words come first: they may be the typing error for which CLI11
/// reports a missing option or subcommand.
std::string complaint_of(const CLI::ParseError& error, const CLI::App& root) {
  const CLI::App& command = asked_command(root);
  const std::vector<std::string> left = root.remaining(true);
  const auto is_option = [](const std::string& word) { return word.starts_with('-'); };
  std::vector<std::string> known = subcommand_names(command);
  const bool is_subcommand = !known.empty() && !left.empty() && !is_option(left.front());
  if (is_subcommand) {
    std::string meant = did_you_mean(left.front(), known);
    if (meant.empty()) meant = did_you_mean("--" + left.front(), option_names(command));
    if (meant.empty() && known.size() == 1) {
      meant = "; did you mean " + known.front() + " " + left.front() + "?";
    }
    return "unknown subcommand \"" + left.front() + "\"" + meant;
  }
  const auto option = std::ranges::find_if(left, is_option);
  if (option != left.end()) {
    const std::string name = option->substr(0, option->find('='));
    return "unknown option " + *option + did_you_mean(name, option_names(command));
  }
  if (!left.empty()) return "\"" + left.front() + "\" is an unexpected argument";
  return in_our_words(error.what());
}

/// A command without arguments prints its help.
bool is_bare(const CLI::App& command, int argc) {
  int words = 0;
  for (const CLI::App* app = &command; app != nullptr; app = app->get_parent()) ++words;
  return argc == words;
}

/// Rule for numbers, `shown` in the help; CLI11 refuses other text. (Its PositiveNumber prints the
/// largest double with 309 digits.)
CLI::Validator number_rule(std::function<bool(double)> holds, const std::string& rule,
                           const std::string& shown) {
  const auto complaint = [holds = std::move(holds), rule](const std::string& given) {
    double value = 0;
    const bool is_number = CLI::detail::lexical_cast(given, value);
    return is_number && !holds(value) ? given + " must be " + rule : std::string();
  };
  return CLI::Validator(complaint, shown);
}

/// An empty value comes from "$UNSET"; CLI11 reads it as 0, or as a missing option.
std::string refuse_empty(const std::string& given) {
  return given.empty() ? "needs a value, not empty text" : "";
}

/// Lines that fit a terminal next to the names; CLI11 indents them.
std::string wrapped(std::string help) {
  constexpr std::size_t kWidth = 70;
  for (std::size_t line = 0; line + kWidth < help.size();) {
    const std::size_t end = help.find_last_of(" \n", line + kWidth);
    if (end == help.npos || end < line) break;  // a longer word
    help[end] = '\n';
    line = end + 1;
  }
  return help;
}

/// CLI11 reads too large numbers as the largest one.
template <typename Number>
std::string refuse_overflow(const std::string& given) {
  Number number = 0;
  const auto read = std::from_chars(given.data(), given.data() + given.size(), number);
  return read.ec == std::errc::result_out_of_range ? one_line(given, 30) + " is too large" : "";
}

/// Name of an option's value in --help, the same in all programs; empty: the type's.
std::string value_name_of(std::string_view option) {
  static constexpr std::pair<std::string_view, std::string_view> kNames[] = {
      {"FILE",
       " --battery --config --csv --curve-out --day-ahead --day-ahead-out --days-out --edge "
       "--edge-log --events --fit --from-teacher --html --junit --log --map --meter-map --out "
       "--output --pinned --plan --prices --program --quarter-hours --real-map --record --replay "
       "--report --rules --settled --simulators --sites --steps --steps-out --student --teacher "
       "--tls-cert --tls-key "},
      {"DIR", " --folder --records --run --source "},
      {"DATE", " --date --from --start --to "},
      {"POLICY", " --policy "},
      {"URL", " --base-url --day-ahead-base-url "}};
  const std::string word = " " + std::string(option) + " ";
  for (const auto& [name, options] : kNames) {
    if (options.find(word) != options.npos) return std::string(name);
  }
  return "";
}

template <typename T>
struct ValueOf {
  using type = T;
};
template <typename T>
struct ValueOf<std::optional<T>> {
  using type = T;
};

/// Refuses options of the root that the subcommand would ignore.
void refuse_options_of_root(const CLI::App& root, const CLI::App& subcommand) {
  const std::vector<std::string> known = option_names(subcommand);
  for (const CLI::Option* option : root.get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || std::ranges::find(known, name) != known.end()) continue;
    throw CLI::ParseError(name + " cannot be used with " + subcommand.get_name(), 2);
  }
}

}  // namespace

ProgramOption& ProgramOption::required() {
  option_->required();
  return *this;
}
ProgramOption& ProgramOption::with_default() {
  option_->capture_default_str();
  return *this;
}
ProgramOption& ProgramOption::checked(const CLI::Validator& rule) {
  option_->check(rule);
  return *this;
}
ProgramOption& ProgramOption::range(int low, int high) { return checked(CLI::Range(low, high)); }
ProgramOption& ProgramOption::range(double low, double high) {
  const std::string rule = formatted("%g to %g", low, high);
  return checked(
      number_rule([=](double x) { return x >= low && x <= high; }, rule, "[" + rule + "]"));
}
ProgramOption& ProgramOption::positive() {
  return checked(number_rule([](double x) { return x > 0; }, "above 0", "POSITIVE"));
}
ProgramOption& ProgramOption::non_negative() {
  return checked(number_rule([](double x) { return x >= 0; }, "0 or more", "NONNEGATIVE"));
}
ProgramOption& ProgramOption::one_of(const std::vector<std::string>& names) {
  return checked(CLI::IsMember(names));
}
ProgramOption& ProgramOption::ipv4() { return checked(CLI::ValidIPV4); }
ProgramOption& ProgramOption::check(
    const std::function<std::string(const std::string&)>& complaint) {
  return checked(CLI::Validator(complaint, ""));
}
ProgramOption& ProgramOption::value_name(const std::string& name) {
  option_->type_name(name);
  return *this;
}
ProgramOption& ProgramOption::excludes(const std::string& other) {
  option_->excludes(other);
  return *this;
}
ProgramOption& ProgramOption::needs(const std::string& other) {
  option_->needs(other);
  return *this;
}

ProgramCommand ProgramCommand::subcommand(const std::string& name, const std::string& description) {
  return ProgramCommand(app_->add_subcommand(name, description));
}
void ProgramCommand::group(const std::string& heading, const std::vector<std::string>& names) {
  for (const std::string& name : names) app_->get_subcommand(name)->group(heading);
}
void ProgramCommand::requires_subcommand() { app_->require_subcommand(1); }

template <typename T>
ProgramOption ProgramCommand::option(const std::string& name, T& value, const std::string& help) {
  CLI::Option* option = app_->add_option(name, value, wrapped(help));
  option->check(CLI::Validator(refuse_empty, ""));
  using Value = typename ValueOf<T>::type;
  const std::string shown = std::is_arithmetic_v<Value> ? "N" : value_name_of(name);
  if (!shown.empty()) option->type_name(shown);
  if constexpr (std::is_integral_v<Value>) {
    option->check(CLI::Validator(refuse_overflow<Value>, ""));
  }
  return ProgramOption(option);
}
#define BESS_OPTION_TYPE(...)                                                     \
  template ProgramOption ProgramCommand::option(const std::string&, __VA_ARGS__&, \
                                                const std::string&)
BESS_OPTION_TYPE(std::string);
BESS_OPTION_TYPE(std::vector<std::string>);
BESS_OPTION_TYPE(int);
BESS_OPTION_TYPE(double);
BESS_OPTION_TYPE(std::uint64_t);
BESS_OPTION_TYPE(std::int64_t);
BESS_OPTION_TYPE(std::optional<std::string>);
BESS_OPTION_TYPE(std::optional<int>);
BESS_OPTION_TYPE(std::optional<double>);
BESS_OPTION_TYPE(std::optional<std::int64_t>);
BESS_OPTION_TYPE(std::optional<std::uint64_t>);
#undef BESS_OPTION_TYPE

ProgramOption ProgramCommand::flag(const std::string& name, bool& value, const std::string& help) {
  return ProgramOption(app_->add_flag(name, value, wrapped(help)));
}

ProgramOption ProgramCommand::parsed(const std::string& name,
                                     std::function<std::string(const std::string&)> take,
                                     const std::string& help) {
  const auto parse = [name, take = std::move(take)](const std::string& given) {
    const std::string complaint = take(given);
    if (!complaint.empty()) throw CLI::ValidationError(name, complaint);
  };
  CLI::Option* option = app_->add_option_function<std::string>(name, parse, wrapped(help));
  option->check(CLI::Validator(refuse_empty, ""));
  return ProgramOption(option);
}

ProgramOption ProgramCommand::named_choice(const std::string& name,
                                           const std::vector<std::string>& names,
                                           const std::string& help,
                                           std::function<void(std::size_t)> chosen) {
  const auto take = [names, chosen = std::move(chosen)](const std::string& given) {
    chosen(static_cast<std::size_t>(std::ranges::find(names, given) - names.begin()));
  };
  CLI::Option* option = app_->add_option_function<std::string>(name, take, wrapped(help));
  option->transform(CLI::IsMember(names, CLI::ignore_case));
  return ProgramOption(option);
}

void ProgramCommand::footer(const std::string& text) { app_->footer(text); }

void ProgramCommand::runs(std::function<void()> action, std::function<std::string()> complaint) {
  if (app_->get_parent() == nullptr) {
    app_->require_subcommand(0, 1);
    app_->parse_complete_callback([app = app_] {
      const CLI::App& asked = asked_command(*app);
      if (&asked != app) refuse_options_of_root(*app, asked);
    });
  }
  app_->callback([app = app_, action = std::move(action), complaint = std::move(complaint)] {
    if (&asked_command(*app) != app) return;
    const std::string wrong = complaint ? complaint() : "";
    if (!wrong.empty()) throw CLI::ParseError(wrong, 2);
    action();
  });
}

void ProgramCommand::exits_with(std::function<int()> action) {
  runs([action = std::move(action)] {
    const int exit_code = action();
    if (exit_code != 0) throw CLI::RuntimeError(exit_code);
  });
}

CommandLine::CommandLine(const std::string& program, const std::string& description,
                         const std::string& version)
    : app_(std::make_unique<CLI::App>(description, program)) {
  app_->require_subcommand(1);
  app_->set_help_flag("-h,--help", "print this help and exit");
  app_->set_version_flag("--version", version, "print the version and exit");
}
CommandLine::~CommandLine() = default;

int CommandLine::run(int argc, const char* const* argv) {
  const char* const program = app_->get_name().c_str();
  const auto refuse = [&](const CLI::App& command, const std::string& complaint) {
    std::fprintf(stderr, "%s: %s (see %s --help)\n", program, one_line(complaint).c_str(),
                 words_of(command).c_str());
    return 2;
  };
  // Control characters in a file name would corrupt messages on a terminal.
  for (int i = 1; i < argc; ++i) {
    if (!holds_control(argv[i])) continue;
    return refuse(
        *app_,
        std::string("\"") + argv[i] +
            "\" contains a line end or another control character: remove it, or rename the file");
  }
  try {
    app_->parse(argc, argv);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      complain_of_output(program, errno);
      return 1;
    }
  } catch (const CLI::RuntimeError& error) {  // of an action, which printed the reason
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app_->exit(error);  // --help, --version
    const CLI::App& command = asked_command(*app_);
    if (is_bare(command, argc)) std::fprintf(stderr, "%s\n", app_->help().c_str());
    return refuse(command, complaint_of(error, *app_));
  } catch (const Interrupted&) {
    std::fprintf(stderr, "%s: interrupted\n", program);
    return 3;
  } catch (const std::filesystem::filesystem_error& error) {  // link loop, name too long
    std::fprintf(stderr, "%s: %s: %s\n", program, one_line(error.path1().string(), 300).c_str(),
                 errno_text(error.code().value()).c_str());
    return 1;
  } catch (const std::system_error& error) {  // {fmt} on a full disk
    if (std::ferror(stdout) == 0) {
      std::fprintf(stderr, "%s: %s\n", program, error.what());
    } else {
      complain_of_output(program, error.code().value());
    }
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program, error.what());
    return 1;
  }
  return 0;
}

void CommandLine::parse(const std::string& line) { app_->parse(line); }

}  // namespace bess
