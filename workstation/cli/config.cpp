// bess-train config: every key with its default, range and meaning.
#include <fmt/core.h>

#include <memory>

#include "workstation/chain/run_config.h"
#include "workstation/cli/commands.h"

namespace bess {

void add_config_command(ProgramCommand& app) {
  auto path = std::make_shared<std::string>();
  ProgramCommand command = app.subcommand("config", "Print the configuration as commented TOML");
  command.option("--config", *path, "File whose values replace the defaults");
  command.footer(
      "Examples:\n"
      "  bess-train config > my.toml\n"
      "  bess-train config --config my.toml     # checks it and shows what is in force");
  command.runs([path] { fmt::print("{}", format_run_config(load_run_config(*path))); });
}

}  // namespace bess
