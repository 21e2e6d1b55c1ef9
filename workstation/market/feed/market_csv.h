// CSV downloads: `;` (portal and API) or `,` (tidy), optional quotes, any column order.
#pragma once

#include "workstation/market/feed/market_rows.h"

namespace bess {

/// `name` is used in messages.
MarketRows parse_market_csv(std::string_view text, std::string_view name);

}  // namespace bess
