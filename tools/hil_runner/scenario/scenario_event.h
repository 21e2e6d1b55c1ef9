// The tables [[event]] of a scenario file.
#pragma once

#include "shared/host/toml_reader.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

void read_event(TomlTable table, Scenario& scenario);

/// Of all of them, in the order of time: refused is what the edge would refuse, what its time
/// cannot do, and what finds nothing to do.
void check_events(TomlTable& root, const Scenario& scenario);

}  // namespace bess
