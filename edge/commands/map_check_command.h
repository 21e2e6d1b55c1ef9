// bess-edge map check: a register map held against a recording of a device, without the device.
#pragma once

#include "edge/commands/command_line.h"
#include "edge/settings/edge_config.h"

namespace bess {

/// `config` null: the map is the command line's. Exit code: 0 all points are plausible, 1 not all, or a file cannot
/// be read.
int run_map_check_command(const CommandLine& command_line, const EdgeConfig* config);

}  // namespace bess
