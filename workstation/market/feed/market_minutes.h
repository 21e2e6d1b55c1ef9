// Minute files as rows, so that what `prices import` wrote can be joined with more, or its settled
// prices be the ground of a reconstruction.
#pragma once

#include <string>

#include "workstation/market/feed/market_rows.h"

namespace bess {

/// Indicative prices as minutes, settled ones as quarter-hours; its sources are those that its
/// comments name.
MarketRows parse_minute_file_rows(std::string_view text, std::string_view name);
/// True of a minute file that a spreadsheet saved with semicolons, and that file with commas and
/// decimal points again, row by row.
bool is_spreadsheet_minute_csv(std::string_view text);
std::string from_spreadsheet(std::string_view text);

}  // namespace bess
