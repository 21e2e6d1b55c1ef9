// What came of a fleet's own impact: a table for the terminal, CSV, JSON, and a page with the money
// a MW over the fleet's size.
#pragma once

#include <filesystem>
#include <string>

#include "shared/host/json.h"
#include "workstation/impact/impact_study.h"

namespace bess {

std::string format_impact_table(const ImpactPlan& plan, const std::vector<ImpactRow>& rows);
/// Header `formula,fleet_mw,variant,...`.
std::string impact_csv(const std::vector<ImpactRow>& rows);
Json impact_json(const ImpactPlan& plan, const std::vector<ImpactRow>& rows);
/// Writes impact.html into `folder`.
void write_impact_page(const ImpactPlan& plan, const std::vector<ImpactRow>& rows,
                       const std::filesystem::path& folder);

}  // namespace bess
