// A price and its minute; where a source has them.
#pragma once

#include <cstdint>

#include "edge/core/base/static_vector.h"
#include "shared/fixed_text.h"

namespace bess {

/// Where the rows are, what their fields are called, and what their prices mean; a dot leads into
/// an inner object.
struct PriceFields {
  FixedText<63> rows = "results";
  FixedText<63> time = "datetime";
  FixedText<63> price = "imbalanceprice";
  std::int32_t eur_per_mwh_e1 = 10;    ///< ten times what 1 in the source's unit is in EUR/MWh
  StaticVector<double, 8> no_price{};  ///< numbers that stand for none, in the source's unit
};

struct PriceRow {
  std::int64_t minute_utc_s = 0;
  std::int32_t price_centi_eur_per_mwh = 0;
  bool is_finer_than_cents = false;  ///< the source's number has more than two decimals
};

}  // namespace bess
