// JSON downloads: the API's records (`results`), exports (a bare array) and version 1
// (`records[].fields`).
#pragma once

#include "workstation/market/feed/market_rows.h"

namespace bess {

/// `name` is used in messages.
MarketRows parse_market_json(std::string_view text, std::string_view name);

}  // namespace bess
