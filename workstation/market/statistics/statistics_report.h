// Market statistics as text, JSON and a picture.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "workstation/market/statistics/market_statistics.h"

namespace bess {

/// `what`: the price that is described.
std::string format_statistics_text(const MarketStatistics& statistics,
                                   std::string_view what = "settled price");
/// One JSON object in one line.
std::string format_statistics_json(const MarketStatistics& statistics);

}  // namespace bess
