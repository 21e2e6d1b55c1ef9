// Prices in any form that is read: told apart by content, parsed by the reader of that form.
#pragma once

#include "workstation/market/feed/market_csv.h"

namespace bess {

/// Elia's CSV or JSON, CSV of one's own, ENTSO-E's XML, minute files and recorded days. `name` is
/// used in messages.
MarketRows parse_market_text(std::string_view text, std::string_view name, const OwnForm& own = {});

}  // namespace bess
