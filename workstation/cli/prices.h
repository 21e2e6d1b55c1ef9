// The subcommands of `bess-train prices`, one file each.
#pragma once

#include <CLI/CLI.hpp>

namespace bess {

void add_prices_simulate(CLI::App& prices);
void add_prices_reconstruct(CLI::App& prices);
void add_prices_import(CLI::App& prices);
void add_prices_fetch(CLI::App& prices);
void add_prices_stats(CLI::App& prices);

}  // namespace bess
