// ENTSO-E's A85 documents.
#include "tests/checks/fuzz/market_promises.h"
#include "workstation/data/market/feed/market_files.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  bess::check_market_reader(bess::parse_entsoe_xml, bess::text_of(data, size));
  return 0;
}
