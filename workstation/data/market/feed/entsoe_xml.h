// ENTSO-E A85 reader: settled imbalance prices of other single-price countries from the
// Transparency Platform (Balancing_MarketDocument, IEC 62325-451-6). A document contains time
// series, these contain periods, these contain points:
//   Period: timeInterval/start, timeInterval/end, resolution (PT15M, PT30M, PT60M)
//   Point:  position (1 = first), imbalance_Price.amount, imbalance_Price.category
//           A04 = price of a long party, A05 = of a short one; equal under single pricing
// curveType A03 omits points that repeat the previous one; with A01 a missing point is a gap.
#pragma once

#include <string_view>

#include "workstation/data/market/feed/market_rows.h"

namespace bess {

bool looks_like_xml(std::string_view text);

/// Quarter-hours in order of time. Those with two different prices get none and are counted in
/// `dual_priced_quarter_hours`. `name` is used in messages. Throws UserError.
MarketRows parse_entsoe_xml(std::string_view text, std::string_view name);

}  // namespace bess
