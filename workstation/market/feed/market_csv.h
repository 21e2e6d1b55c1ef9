// CSV: downloads and files of one's own, `;` `,` or tabs, optional quotes, any column order.
#pragma once

#include "workstation/market/feed/market_rows.h"
#include "workstation/market/feed/own_times.h"

namespace bess {

/// How a file of one's own is read: names of columns, empty where they are to be found.
struct OwnForm {
  std::string time_column, price_column;
  OwnTimes times;
};

/// Without a resolution code the rows are minutes or quarter-hours by how far apart they are, and
/// contradictions of one time are an error. `name` is used in messages.
MarketRows parse_market_csv(std::string_view text, std::string_view name, const OwnForm& own = {});

}  // namespace bess
