// Minute files: the exchange format between market import and training.
#include "tests/checks/fuzz/market_promises.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  bess::check_minute_reader(bess::text_of(data, size));
  return 0;
}
