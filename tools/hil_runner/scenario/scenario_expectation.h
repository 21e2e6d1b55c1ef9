// The tables [[expect]] of a scenario file.
#pragma once

#include "shared/host/toml_reader.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

/// Refused is as well what no run could break, and what none could keep.
void read_expectation(TomlTable table, Scenario& scenario);

}  // namespace bess
