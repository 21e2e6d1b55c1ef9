// Configurations of bess-train.
#include "shared/host/user_error.h"
#include "tests/checks/fuzz/fuzz_target.h"
#include "workstation/runs/chain/run_config.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bess;
  std::string written;
  try {
    written = format_run_config(parse_run_config(text_of(data, size), "fuzz"));
  } catch (const UserError&) {
    return 0;
  }
  must(format_run_config(parse_run_config(written, "written")) == written,
       "what is written reads back to the same");
  return 0;
}
