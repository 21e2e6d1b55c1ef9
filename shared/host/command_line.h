// The command line of a program, with or without subcommands: options into variables, help, errors,
// exit codes. CLI11 does the work; only command_line.cpp includes it, because its header takes a
// compiler longer than all else in a command. Declare in this order: program, subcommands, their
// options; then run().
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
}  // namespace CLI

namespace bess {

/// Thrown when Ctrl-C stopped a command after it saved what it had.
struct Interrupted {};

/// One option or positional argument while it is declared. Rules add up; a value that breaks one
/// ends the program with one line and exit code 2.
class ProgramOption {
 public:
  explicit ProgramOption(CLI::Option* option) : option_(option) {}
  ProgramOption& required();
  /// Shows the variable's present value in the help.
  ProgramOption& with_default();
  ProgramOption& range(int low, int high);
  ProgramOption& range(double low, double high);
  ProgramOption& positive();
  ProgramOption& non_negative();
  ProgramOption& one_of(const std::vector<std::string>& names);
  ProgramOption& ipv4();
  /// `complaint` returns what is wrong with a value, or nothing.
  ProgramOption& check(const std::function<std::string(const std::string&)>& complaint);
  /// What stands for the value in the help.
  ProgramOption& value_name(const std::string& name);
  /// `other` names an option that is declared already.
  ProgramOption& excludes(const std::string& other);
  ProgramOption& needs(const std::string& other);

 private:
  CLI::Option* option_;
};

/// A command or subcommand while it is declared.
class ProgramCommand {
 public:
  explicit ProgramCommand(CLI::App* app) : app_(app) {}
  /// Heading in the help for subcommands declared before.
  void group(const std::string& heading, const std::vector<std::string>& names);
  ProgramCommand subcommand(const std::string& name, const std::string& description);
  /// One of the subcommands must be given.
  void requires_subcommand();
  /// A name without dashes is a positional argument. Text, whole and decimal numbers, each also
  /// std::optional (stays empty unless given), and lists of text. An empty value, and a number too
  /// large to hold, are refused.
  template <typename T>
  ProgramOption option(const std::string& name, T& value, const std::string& help);
  ProgramOption flag(const std::string& name, bool& value, const std::string& help);
  /// A value with a syntax of its own: `take` stores it and returns what is wrong with it, or
  /// nothing.
  ProgramOption parsed(const std::string& name, std::function<std::string(const std::string&)> take,
                       const std::string& help);
  /// A name for each value; upper and lower case are one.
  template <typename T>
  ProgramOption choice(const std::string& name, T& value,
                       const std::vector<std::pair<std::string, T>>& choices,
                       const std::string& help) {
    std::vector<std::string> names;
    for (const auto& choice : choices) names.push_back(choice.first);
    return named_choice(name, names, help,
                        [choices, &value](std::size_t i) { value = choices[i].second; });
  }
  /// Text behind the options: examples.
  void footer(const std::string& text);
  /// What the command does, once everything is parsed. `complaint` returns what is wrong with
  /// options that are right each by itself, or nothing; the command is then not run. A program
  /// whose root runs needs no subcommand.
  void runs(std::function<void()> action, std::function<std::string()> complaint = nullptr);
  /// The same, of an action that returns the program's exit code.
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
  /// Parses, runs the command's action, and turns every error into one line on stderr, which names
  /// the nearest known word and the help of the command that was asked for; a command that is given
  /// nothing shows that help as well. Returns the exit code.
  int run(int argc, const char* const* argv);
  /// Parses one line and runs its action; errors are thrown. For tests.
  void parse(const std::string& line);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace bess
