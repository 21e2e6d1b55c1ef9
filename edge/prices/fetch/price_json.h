// Price JSON of a server, parsed to rows of minutes. Prices are integers in 0.01 EUR/MWh.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "edge/core/base/status.h"
#include "edge/prices/record/price_row.h"

namespace bess {

struct PriceAnswer {
  Status status = Status::kNoRow;  ///< kOk: there is a row
  std::vector<PriceRow> rows{};    ///< usable rows, in the answer's order
  int items = 0;                   ///< rows in the answer, usable or not
};

/// Parses a list at `fields.rows`, or a bare list, in any order. Skips rows without a numeric
/// price, from the future, beyond +-100,000 EUR/MWh, or with a duplicate time or price member.
/// Malformed: also data after the end, or a duplicate member of rows.
PriceAnswer parse_prices(std::string_view json, const PriceFields& fields, std::int64_t now_utc_s);

/// Newest usable row of an answer.
Status parse_newest_price(std::string_view json, const PriceFields& fields, std::int64_t now_utc_s,
                          PriceRow& row);

}  // namespace bess
