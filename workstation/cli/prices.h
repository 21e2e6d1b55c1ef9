// The subcommands of `bess-train prices`, one file each.
#pragma once

#include "shared/host/command_line.h"

namespace bess {

void add_prices_simulate(ProgramCommand& prices);
void add_prices_reconstruct(ProgramCommand& prices);
void add_prices_import(ProgramCommand& prices);
void add_prices_fetch(ProgramCommand& prices);
void add_prices_record(ProgramCommand& prices);
void add_prices_stats(ProgramCommand& prices);

}  // namespace bess
