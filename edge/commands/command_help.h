// What `bess-edge --help` and `bess-edge COMMAND --help` print.
#pragma once

#include "edge/commands/command_line.h"

namespace bess {

const char* help_of(SubCommand command);

}  // namespace bess
