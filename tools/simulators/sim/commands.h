// Subcommands of bess-sim: each declares its options and help, and runs as a callback.
#pragma once

#include "shared/host/command_line.h"

namespace bess {

void add_battery_command(ProgramCommand& app);
void add_market_command(ProgramCommand& app);
void add_settle_command(ProgramCommand& app);
void add_site_command(ProgramCommand& app);

}  // namespace bess
