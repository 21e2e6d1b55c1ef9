#include "shared/host/command_line.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <optional>
#include <system_error>

namespace bess {
namespace {

void complain_of_output(const char* program, int error) {
  std::fprintf(stderr, "%s: cannot write to the standard output: %s\n", program,
               std::strerror(error));
}

/// The first word that names no subcommand where one is due, or an empty text. CLI11 would only say
/// that a subcommand is missing.
std::string unknown_subcommand(const CLI::App& app, int argc, const char* const* argv) {
  const CLI::App* command = &app;
  for (int i = 1; i < argc; ++i) {
    std::string word = argv[i];
    const auto subcommands = command->get_subcommands([](const CLI::App*) { return true; });
    if (subcommands.empty() || word.starts_with('-')) break;
    const auto found = std::ranges::find(subcommands, word, &CLI::App::get_name);
    if (found == subcommands.end()) return word;
    command = *found;
  }
  return "";
}

/// A rule for numbers in words; what is no number at all is CLI11's to refuse. (Its own PositiveNumber
/// prints the largest double with all its 309 digits.)
std::function<std::string(std::string&)> number_rule(std::function<bool(double)> holds,
                                                     const std::string& rule) {
  return [holds = std::move(holds), rule](const std::string& given) {
    double value = 0;
    const bool is_number = CLI::detail::lexical_cast(given, value);
    return is_number && !holds(value) ? given + " must be " + rule : std::string();
  };
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
ProgramOption& ProgramOption::range(int low, int high) {
  option_->check(CLI::Range(low, high));
  return *this;
}
ProgramOption& ProgramOption::range(double low, double high) {
  option_->check(CLI::Range(low, high));
  return *this;
}
ProgramOption& ProgramOption::positive() {
  option_->check(
      CLI::Validator(number_rule([](double x) { return x > 0; }, "above 0"), "POSITIVE"));
  return *this;
}
ProgramOption& ProgramOption::non_negative() {
  option_->check(
      CLI::Validator(number_rule([](double x) { return x >= 0; }, "0 or more"), "NONNEGATIVE"));
  return *this;
}
ProgramOption& ProgramOption::one_of(const std::vector<std::string>& names) {
  option_->check(CLI::IsMember(names));
  return *this;
}
ProgramOption& ProgramOption::ipv4() {
  option_->check(CLI::ValidIPV4);
  return *this;
}
ProgramOption& ProgramOption::check(
    const std::function<std::string(const std::string&)>& complaint) {
  option_->check(CLI::Validator(complaint, ""));
  return *this;
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
void ProgramCommand::requires_subcommand() { app_->require_subcommand(1); }

template <typename T>
ProgramOption ProgramCommand::option(const std::string& name, T& value, const std::string& help) {
  return ProgramOption(app_->add_option(name, value, help));
}
#define BESS_OPTION_TYPE(...)                                                     \
  template ProgramOption ProgramCommand::option(const std::string&, __VA_ARGS__&, \
                                                const std::string&)
BESS_OPTION_TYPE(std::string);
BESS_OPTION_TYPE(std::vector<std::string>);
BESS_OPTION_TYPE(int);
BESS_OPTION_TYPE(double);
BESS_OPTION_TYPE(std::uint8_t);
BESS_OPTION_TYPE(std::uint64_t);
BESS_OPTION_TYPE(std::int64_t);
BESS_OPTION_TYPE(std::optional<std::string>);
BESS_OPTION_TYPE(std::optional<int>);
BESS_OPTION_TYPE(std::optional<double>);
BESS_OPTION_TYPE(std::optional<std::int64_t>);
BESS_OPTION_TYPE(std::optional<std::uint64_t>);
#undef BESS_OPTION_TYPE

ProgramOption ProgramCommand::flag(const std::string& name, bool& value, const std::string& help) {
  return ProgramOption(app_->add_flag(name, value, help));
}

ProgramOption ProgramCommand::named_choice(const std::string& name,
                                           const std::vector<std::string>& names,
                                           const std::string& help,
                                           std::function<void(std::size_t)> chosen) {
  const auto take = [names, chosen = std::move(chosen)](const std::string& given) {
    chosen(static_cast<std::size_t>(std::ranges::find(names, given) - names.begin()));
  };
  CLI::Option* option = app_->add_option_function<std::string>(name, take, help);
  option->transform(CLI::IsMember(names, CLI::ignore_case));
  return ProgramOption(option);
}

void ProgramCommand::footer(const std::string& text) { app_->footer(text); }
void ProgramCommand::runs(std::function<void()> action) { app_->callback(std::move(action)); }

CommandLine::CommandLine(const std::string& program, const std::string& description,
                         const std::string& version)
    : app_(std::make_unique<CLI::App>(description, program)) {
  app_->require_subcommand(1);
  app_->set_version_flag("--version", version);
}
CommandLine::~CommandLine() = default;

int CommandLine::run(int argc, const char* const* argv) {
  const char* const program = app_->get_name().c_str();
  if (const std::string word = unknown_subcommand(*app_, argc, argv); !word.empty()) {
    std::fprintf(stderr, "%s: unknown subcommand \"%s\" (see %s --help)\n", program, word.c_str(),
                 program);
    return 2;
  }
  try {
    app_->parse(argc, argv);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      complain_of_output(program, errno);
      return 1;
    }
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app_->exit(error);  // --help, --version
    std::fprintf(stderr, "%s: %s (see %s --help)\n", program, error.what(), program);
    return 2;
  } catch (const Interrupted&) {
    std::fprintf(stderr, "%s: interrupted\n", program);
    return 3;
  } catch (const std::system_error& error) {  // {fmt}, when a long output meets a full disk
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
