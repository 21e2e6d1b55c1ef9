// bess-edge record: reads what the register map names, again and again, and writes every request and reply to a
// file that can be given away. Writes nothing to the device. `bess-edge run --record` records a controller at work.
#pragma once

#include <string>

#include "edge/commands/command_line.h"
#include "edge/program/edge_clock.h"
#include "edge/settings/edge_config.h"

namespace bess {

/// Exit code: 0 recorded (also when stopped early), 1 the file cannot be written, or nobody answered.
int run_record_command(const CommandLine& command_line, const EdgeConfig& config, EdgeClock& clock);

}  // namespace bess
