// Market statistics as text, JSON and a picture.
#pragma once

#include <filesystem>
#include <string>

#include "workstation/market/statistics/market_statistics.h"

namespace bess {

std::string format_statistics_text(const MarketStatistics& statistics);
/// One JSON object in one line.
std::string format_statistics_json(const MarketStatistics& statistics);

}  // namespace bess
