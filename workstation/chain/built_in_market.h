// The market of a run that was given no prices: one local year, so that every month is seen.
#pragma once

#include <string>

#include "shared/host/minute_file.h"

namespace bess {

inline constexpr const char* kBuiltInMarketName = "built-in market";

MinuteSeries built_in_market();
/// What its minute file says about it.
std::string built_in_market_provenance();

/// How the provenance of made-up prices begins.
inline constexpr const char* kSimulatedProvenance = "Simulated, not real";

}  // namespace bess
