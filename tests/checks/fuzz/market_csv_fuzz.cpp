// Elia's CSV downloads in the spelling of any portal and year, and own CSV with local clocks.
#include "tests/checks/fuzz/market_promises.h"
#include "workstation/data/market/feed/market_files.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  for (const char* format : {"yyyy-mm-dd", "dd/mm/yyyy"}) {
    const bess::CustomCsvFormat own{"", "", {format, bess::WallClock::kLocal}};
    bess::check_market_reader(
        [&own](std::string_view text, std::string_view name) {
          return bess::parse_market_csv(text, name, own);
        },
        bess::text_of(data, size));
  }
  return 0;
}
