// [day_ahead] of a scenario: the day-ahead prices that its market publishes, and what goes wrong
// with them, for an edge whose student is by outlook.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shared/host/toml_reader.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

/// A relative `file` is beside the scenario, in `folder`.
void read_day_ahead(TomlTable table, const std::filesystem::path& folder, Scenario& scenario);

/// The scenario's file; without one made up, from the local day before the start to two after the
/// end: by hour a morning, a noon and an evening, by date another height, no two quarter-hours of
/// an hour alike.
std::string day_ahead_csv(const Scenario& scenario);
std::vector<AuctionRow> day_ahead_rows(const Scenario& scenario);

}  // namespace bess
