// bess-train prices: where minute files come from.
#include "workstation/cli/commands.h"

namespace bess {

void add_prices_commands(ProgramCommand& app) {
  ProgramCommand prices = app.subcommand("prices", "Get, build or describe minute price files");
  prices.requires_subcommand();
  add_prices_simulate(prices);
  add_prices_reconstruct(prices);
  add_prices_import(prices);
  add_prices_fetch(prices);
  add_prices_stats(prices);
}

}  // namespace bess
