// bess-train: from prices to a proved, exported student. Each subcommand lives in cli/; this file
// only wires them together and turns errors into one line and an exit code.
//   exit 0 done   1 the input or its content is bad   2 the command line is bad   3 interrupted
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>

#include "shared/local_time.h"
#include "workstation/cli/commands.h"

namespace {

/// CLI11 would only say that a subcommand is missing, not that this one does not exist.
bool is_subcommand_or_option(const CLI::App& app, const std::string& word) {
  if (word.starts_with('-')) return true;
  const auto subcommands = app.get_subcommands([](const CLI::App*) { return true; });
  return std::ranges::any_of(subcommands, [&](const CLI::App* s) { return s->get_name() == word; });
}

}  // namespace

int main(int argc, char** argv) {
  bess::set_market_time_zone();
  CLI::App app{"bess-train: train, correct, prove and export a battery arbitrage policy",
               "bess-train"};
  app.require_subcommand(1);
  app.set_version_flag("--version", BESS_VERSION);
  bess::add_commands(app);
  if (argc > 1 && !is_subcommand_or_option(app, argv[1])) {
    std::fprintf(stderr, "bess-train: unknown subcommand \"%s\" (see bess-train --help)\n", argv[1]);
    return 2;
  }
  try {
    app.parse(argc, argv);
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
