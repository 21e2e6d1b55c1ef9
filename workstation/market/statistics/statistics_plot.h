// The picture of a market, drawn by gnuplot: how prices are distributed, and how fast the
// indicative price finds the settled one.
#pragma once

#include <filesystem>
#include <span>

#include "workstation/market/statistics/market_statistics.h"

namespace bess {

/// Throws UserError unless a picture can be made at `path`, creating its folder.
void require_drawable(const std::filesystem::path& path);

/// Writes .svg or .png by the name of `path`, and beside it the same on dark paper, NAME_dark.
/// `settled` holds one price a quarter-hour. Throws UserError when there is nothing to draw, or
/// gnuplot is missing or fails; then nothing is left under the final name.
void plot_statistics(const std::filesystem::path& path, const MarketStatistics& statistics,
                     std::span<const double> settled);

}  // namespace bess
