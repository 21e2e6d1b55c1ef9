// Command line of a program, with or without subcommands: options into variables, help, errors,
// exit codes, with CLI11. Only command_line.cpp includes CLI11, because it is slow to compile.
// Declare in this order: program, subcommands, their options; then run().
//   exit 0 done   1 the input or its content is bad   2 the command line is bad   3 interrupted
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

namespace bess {

/// Thrown after Ctrl-C, when the command has saved its state.
struct Interrupted {};

/// Option or positional argument during declaration. Rules accumulate; a violation ends the program
/// with one line and exit code 2.
class ProgramOption {
 public:
  explicit ProgramOption(CLI::Option* option) : option_(option) {}
  ProgramOption& required();
  /// Shows the present value of the variable in the help.
  ProgramOption& with_default();
  ProgramOption& range(int low, int high);
  ProgramOption& range(double low, double high);
  ProgramOption& positive();
  ProgramOption& non_negative();
  ProgramOption& one_of(const std::vector<std::string>& names);
  ProgramOption& ipv4();
  /// `complaint` returns an error or "".
  ProgramOption& check(const std::function<std::string(const std::string&)>& complaint);
  /// Placeholder of the value in the help.
  ProgramOption& value_name(const std::string& name);
  /// `other`: an option declared before.
  ProgramOption& excludes(const std::string& other);
  ProgramOption& needs(const std::string& other);

 private:
  ProgramOption& checked(const CLI::Validator& rule);

  CLI::Option* option_;
};

/// Command or subcommand during declaration.
class ProgramCommand {
 public:
  explicit ProgramCommand(CLI::App* app) : app_(app) {}
  /// Heading in the help for subcommands declared before.
  void group(const std::string& heading, const std::vector<std::string>& names);
  ProgramCommand subcommand(const std::string& name, const std::string& description);
  /// Requires one of the subcommands.
  void requires_subcommand();
  /// A name without dashes is a positional argument. Types: text, whole and decimal numbers, each
  /// also std::optional, and lists of text. Refuses empty values and numbers that are too large.
  template <typename T>
  ProgramOption option(const std::string& name, T& value, const std::string& help);
  ProgramOption flag(const std::string& name, bool& value, const std::string& help);
  /// Value with its own syntax: `take` stores it and returns an error or "".
  ProgramOption parsed(const std::string& name, std::function<std::string(const std::string&)> take,
                       const std::string& help);
  /// Value by name, case-insensitive.
  template <typename T>
  ProgramOption choice(const std::string& name, T& value,
                       const std::vector<std::pair<std::string, T>>& choices,
                       const std::string& help) {
    std::vector<std::string> names;
    for (const auto& choice : choices) names.push_back(choice.first);
    return named_choice(name, names, help,
                        [choices, &value](std::size_t i) { value = choices[i].second; });
  }
  /// Text after the options: examples.
  void footer(const std::string& text);
  /// Action of the command, after parsing. `complaint` returns a contradiction between options or
  /// ""; with one the action is not run. A program whose root runs needs no subcommand.
  void runs(std::function<void()> action, std::function<std::string()> complaint = nullptr);
  /// The same for an action that returns the exit code.
  void exits_with(std::function<int()> action);

 private:
  ProgramOption named_choice(const std::string& name, const std::vector<std::string>& names,
                             const std::string& help, std::function<void(std::size_t)> chosen);
  CLI::App* app_;
};

class CommandLine {
 public:
  CommandLine(const std::string& program, const std::string& description,
              const std::string& version);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  [[nodiscard]] ProgramCommand root() { return ProgramCommand(app_.get()); }
  /// Parses and runs the action. Each error becomes one line on stderr with the nearest known word
  /// and the help command; a command without arguments also prints its help. Returns the exit code.
  int run(int argc, const char* const* argv);
  /// Parses one line and runs its action; throws errors. For tests.
  void parse(const std::string& line);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace bess
