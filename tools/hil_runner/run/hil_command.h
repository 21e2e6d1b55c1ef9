// Command line of bess-hil.
#pragma once

#include "shared/host/command_line.h"

namespace bess {

void add_run_command(ProgramCommand& app);

}  // namespace bess
