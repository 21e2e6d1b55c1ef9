// Register maps: whatever is accepted keeps its promises about the power it can express.
#include "edge/registers/codec.h"
#include "edge/registers/map_file.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/scratch_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bess;
  static const ScratchFile file("map.toml");
  const std::string path = file.holding(text_of(data, size));
  RegisterMap map;
  std::string error;
  const bool ok = load_register_map(path, "", map, error);
  must(ok == error.empty(), "refused with a reason, accepted without");
  must(error.find('\n') == std::string::npos, "one line");
  if (!ok) return 0;
  must(map.charge_w_max > 0 && map.discharge_w_max > 0, "an accepted map can express power");
  for (const std::int32_t power_w : {map.charge_w_max, 0, -map.discharge_w_max}) {
    const PowerOrder order{.power_w = power_w, .duration_s = map.dead_man_duration_s};
    must(check_expressible(map, order) == Status::kOk,
         "the power it states goes into its registers");
  }
  return 0;
}
