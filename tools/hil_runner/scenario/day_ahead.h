// [day_ahead] of a scenario: published day-ahead prices and their faults, for a student with
// context outlook.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shared/host/toml_reader.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

/// A relative `file` is in `folder`, that of the scenario.
void read_day_ahead(TomlTable table, const std::filesystem::path& folder, Scenario& scenario);

/// File of the scenario; else synthetic prices from the local day before the start to two days
/// after the end, with a morning, noon and evening pattern, a level by date, and distinct
/// quarter-hours.
std::string day_ahead_csv(const Scenario& scenario);
std::vector<AuctionRow> day_ahead_rows(const Scenario& scenario);

}  // namespace bess
