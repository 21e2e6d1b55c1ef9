// A price server's JSON as rows of minutes. Prices leave here as integer hundredths of EUR/MWh.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "edge/core/base/status.h"
#include "edge/prices/record/price_row.h"

namespace bess {

struct PriceAnswer {
  Status status = Status::kNoRow;  ///< kOk: there is a row
  std::vector<PriceRow> rows{};    ///< the usable ones, in the answer's order
  int items = 0;                   ///< rows in the answer, usable or not
};

/// A list at `fields.rows`, or a bare list, in any order. Rows without a price that is a number,
/// later than now, beyond +-100,000 EUR/MWh, or with time or price twice, are passed over.
/// Malformed is also an answer with anything behind its end, and one whose field of rows stands
/// twice.
PriceAnswer parse_prices(std::string_view json, const PriceFields& fields, std::int64_t now_utc_s);

/// The newest usable row of an answer.
Status parse_newest_price(std::string_view json, const PriceFields& fields, std::int64_t now_utc_s,
                          PriceRow& row);

}  // namespace bess
