// The commands of bess-edge, in the order of its help. NAME_command.cpp declares each.
#pragma once

#include "edge/commands/command.h"

namespace bess {

void add_commission(EdgeCommand root);
void add_release(EdgeCommand root);
void add_clear(EdgeCommand root);
void add_status(EdgeCommand root);
void add_log(EdgeCommand root);
void add_why(EdgeCommand root);
void add_earned(EdgeCommand root);
void add_hold(EdgeCommand root);
void add_limit(EdgeCommand root);
void add_record(EdgeCommand root);
void add_map_check(EdgeCommand root);
void add_signature(EdgeCommand root);
/// What bess-edge does without a command. Last: commands declared later would have its footer.
void add_run(EdgeCommand root);

}  // namespace bess
