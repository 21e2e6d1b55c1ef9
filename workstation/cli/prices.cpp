// bess-train prices: where minute files come from.
#include "workstation/cli/commands.h"

namespace bess {

void add_prices_commands(CLI::App& app) {
  app.add_subcommand("prices", "Get, build or describe minute price files");
}

}  // namespace bess
