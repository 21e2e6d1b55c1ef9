// A price server's JSON, reduced to the newest usable minute row. The only edge file pair that
// knows cJSON. Prices leave here as integer hundredths of EUR/MWh. Between http_client and
// price_feed.
#pragma once

#include <cstdint>
#include <string_view>

#include "edge/base/status.h"
#include "edge/prices/price_row.h"

namespace bess {

/// Newest usable row of an answer: a list at `fields.rows`, or a bare list, in any order.
/// Its time is text with an offset (2023-03-26T01:02:00+00:00) or a number of seconds or
/// milliseconds since 1970. Rows without a price that is a number, later than now, beyond +-100,000
/// EUR/MWh, or with time or price twice, are passed over. Malformed is also an answer with anything
/// behind its end, and one whose field of rows stands twice, which is ambiguous.
Status parse_newest_price(std::string_view json, const PriceFields& fields, std::int64_t now_utc_s,
                          PriceRow& row);

/// Every usable row of an answer, in its order; kNoRow when none is. `items`: rows in the answer,
/// usable or not.
Status parse_prices(std::string_view json, const PriceFields& fields, std::int64_t now_utc_s,
                    const PriceRowTaker& taker, int& items);

/// Every row that has a price, in the order of a day-ahead answer, whatever its time; the same
/// otherwise. Without `fields.rows` times and prices are two lists of one length side by side, as
/// energy-charts has them.
Status parse_day_ahead(std::string_view json, const PriceFields& fields,
                       const PriceRowTaker& taker);

}  // namespace bess
