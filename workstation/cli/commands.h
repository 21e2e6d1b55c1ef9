// The subcommands of bess-train: one file each in this folder, which declares its options, its help
// with examples, and runs it as the subcommand's callback.
#pragma once

#include <CLI/CLI.hpp>

namespace bess {

/// Thrown when Ctrl-C stopped a command after it saved what it had.
struct Interrupted {};

void add_prices_commands(CLI::App& app);  ///< simulate, reconstruct, import, fetch, stats

/// Every subcommand, in the order of the help.
void add_commands(CLI::App& app);

}  // namespace bess
