// The subcommands of bess-sim; each declares its options, its help with examples, and runs as a
// callback.
#pragma once

#include <CLI/CLI.hpp>

namespace bess {

void add_battery_command(CLI::App& app);
void add_market_command(CLI::App& app);
void add_settle_command(CLI::App& app);

}  // namespace bess
