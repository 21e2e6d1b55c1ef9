// Price row: a price and its minute, and the fields of a source.
#pragma once

#include <cstdint>

#include "edge/core/base/static_vector.h"
#include "shared/fixed_text.h"

namespace bess {

/// Location of the rows, names of their fields, and meaning of their prices; a dot leads into an
/// inner object.
struct PriceFields {
  FixedText<63> rows = "results";
  FixedText<63> time = "datetime";
  FixedText<63> price = "imbalanceprice";
  std::int32_t eur_per_mwh_e1 = 10;    ///< EUR/MWh of one source unit, times ten
  StaticVector<double, 8> no_price{};  ///< numbers that mean "no price", in the source's unit
};

struct PriceRow {
  std::int64_t minute_utc_s = 0;
  std::int32_t price_centi_eur_per_mwh = 0;
  bool is_finer_than_cents = false;  ///< the source's number has more than two decimals
};

}  // namespace bess
