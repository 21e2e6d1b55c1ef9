// Elia's CSV downloads, of any portal's and year's spelling.
#include "tests/fuzz/market_promises.h"
#include "workstation/market/feed/market_csv.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  bess::check_market_reader(bess::parse_market_csv, bess::text_of(data, size));
  return 0;
}
