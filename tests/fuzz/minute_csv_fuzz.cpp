// The exchange format between markets and everything that learns: minute files.
#include "tests/fuzz/fuzz_target.h"
#include "workstation/io/user_error.h"
#include "workstation/market/minute_series.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bess;
  MinuteSeries series;
  try {
    series = parse_minute_csv(text_of(data, size), "fuzz");
  } catch (const UserError&) {
    return 0;
  }
  must(series.indicative.size() == series.settled.size(), "both prices for each minute");
  const std::string written = format_minute_csv(series, "");
  must(format_minute_csv(parse_minute_csv(written, "written"), "") == written,
       "what is written reads back to the same");
  return 0;
}
