// Answers of the price server, as the edge reads them.
#include "edge/prices/fetch/price_json.h"
#include "shared/units_and_limits.h"
#include "tests/checks/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bess;
  constexpr std::int64_t kNowUtc_s = 1'755'400'000;
  PriceRow row;
  if (parse_newest_price(text_of(data, size), PriceFields{}, kNowUtc_s, row) == Status::kOk) {
    must(row.minute_utc_s <= kNowUtc_s, "no row from the future");
    must(row.minute_utc_s % 60 == 0, "a row is of a whole minute");
    must(row.price_centi_eur_per_mwh >= -kPlausiblePriceMaxCentiEurPerMwh &&
             row.price_centi_eur_per_mwh <= kPlausiblePriceMaxCentiEurPerMwh,
         "a plausible price");
  }
  return 0;
}
