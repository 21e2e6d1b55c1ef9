// bess-train: from prices to a proved, exported student. Each subcommand lives in cli/; this file
// only wires them together and turns errors into one line and an exit code.
//   exit 0 done   1 the input or its content is bad   2 the command line is bad   3 interrupted
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>

#include "shared/local_time.h"
#include "workstation/cli/commands.h"
#include "workstation/cli/common_options.h"

namespace {

/// The first word that names no subcommand where one is due, or an empty text. CLI11 would only say that a
/// subcommand is missing.
std::string unknown_subcommand(const CLI::App& app, int argc, char** argv) {
  const CLI::App* command = &app;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto subcommands = command->get_subcommands([](const CLI::App*) { return true; });
    if (subcommands.empty() || word.starts_with('-')) break;
    const auto found = std::ranges::find(subcommands, word, &CLI::App::get_name);
    if (found == subcommands.end()) return word;
    command = *found;
  }
  return "";
}

}  // namespace

int main(int argc, char** argv) {
  bess::set_market_time_zone();
  CLI::App app{"bess-train: train, correct, prove and export a battery arbitrage policy",
               "bess-train"};
  app.require_subcommand(1);
  app.set_version_flag("--version", BESS_VERSION);
  bess::add_commands(app);
  if (const std::string word = unknown_subcommand(app, argc, argv); !word.empty()) {
    std::fprintf(stderr, "bess-train: unknown subcommand \"%s\" (see bess-train --help)\n",
                 word.c_str());
    return 2;
  }
  bess::end_when_interrupted();
  try {
    app.parse(argc, argv);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      std::fprintf(stderr, "bess-train: cannot write to the standard output: %s\n",
                   std::strerror(errno));
      return 1;
    }
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    std::fprintf(stderr, "bess-train: %s (see bess-train --help)\n", error.what());
    return 2;
  } catch (const bess::Interrupted&) {
    std::fprintf(stderr, "bess-train: interrupted\n");
    return 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bess-train: %s\n", error.what());
    return 1;
  }
  return 0;
}
