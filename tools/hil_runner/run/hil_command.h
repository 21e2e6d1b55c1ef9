// bess-hil's command line: which scenarios, in which time, told how.
#pragma once

#include "shared/host/command_line.h"

namespace bess {

void add_run_command(ProgramCommand& app);

}  // namespace bess
