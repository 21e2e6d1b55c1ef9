// The tables of a scenario that are about the site: the house behind the same meter, the meter, and
// what is wrong with it.
#pragma once

#include "shared/host/toml_reader.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

void read_house(TomlTable table, Scenario& scenario);
void read_meter(TomlTable table, const std::filesystem::path& folder, ScenarioMeter& meter);
void read_meter_fault(TomlTable table, Scenario& scenario);

/// One without the other, or lines for the edge about what is not there, would be in vain.
void check_site(TomlTable& root, const Scenario& scenario);

}  // namespace bess
