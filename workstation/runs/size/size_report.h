// Size report: table, CSV, JSON, and a page with a heat map per contract.
#pragma once

#include <filesystem>
#include <string>

#include "shared/host/json.h"
#include "workstation/runs/size/size_cell.h"

namespace bess {

struct SizeReport {
  const SizePlan& plan;
  const SizeCells& weighed;
  std::string provenance;  ///< one line: prices, policy, window
};

std::string format_size_table(const SizeReport& report);
/// Header `power_kw,capacity_kwh,contract,...`, one row per cell.
std::string size_csv(const SizeReport& report);
Json size_json(const SizeReport& report);
/// Writes size.html into `folder`.
void write_size_page(const SizeReport& report, const std::filesystem::path& folder);

}  // namespace bess
