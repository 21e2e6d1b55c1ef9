// The commands of bess-edge, in the order of its help. A row is a command: NAME_command.cpp defines
// it: kNAMECommand.
#pragma once

#include "edge/commands/command.h"

namespace bess {

#define BESS_COMMANDS(ROW) \
  ROW(Run)                 \
  ROW(Commission)          \
  ROW(Release)             \
  ROW(Clear)               \
  ROW(Status)              \
  ROW(Log)                 \
  ROW(Why)                 \
  ROW(Earned)              \
  ROW(Hold)                \
  ROW(Limit)               \
  ROW(Record)              \
  ROW(MapCheck)            \
  ROW(Signature)

#define BESS_ROW(name) extern const EdgeCommand k##name##Command;
BESS_COMMANDS(BESS_ROW)
#undef BESS_ROW

inline constexpr const EdgeCommand* kCommands[] = {
#define BESS_ROW(name) &k##name##Command,
    BESS_COMMANDS(BESS_ROW)
#undef BESS_ROW
};

}  // namespace bess
