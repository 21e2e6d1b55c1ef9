// Line of an outside limit: refused, or complete and within its range.
#include "edge/core/site/connection_guard.h"
#include "tests/checks/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bess;
  const std::string_view text = text_of(data, size);
  OutsideLimit limit;
  if (parse_outside_limit(text, limit) != Status::kOk) return 0;
  must(text.ends_with('\n'), "a line that was cut short is refused");
  must(limit.charge_w_max >= 0 && limit.discharge_w_max >= 0, "powers are 0 or more");
  must(limit.until_utc_s > -86'400, "an instant since 1970");
  return 0;
}
